// Curvature of every vertex by CGAL's jet fitting, for benches/peers.py.
//
// cgal_jets IN.stl OUT.bin DEGREE RINGS
//   IN.stl    binary STL; equal positions are welded
//   OUT.bin   per vertex k_max and k_min as 64-bit floats, positive where the surface bends away from its normal
// Neighbourhoods are RINGS rings of vertices, more where these hold fewer points than the fit needs.
//
// g++ -O3 -march=native -DNDEBUG cgal_jets.cpp -o cgal_jets    (Debian: libcgal-dev, libeigen3-dev)
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Simple_cartesian.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <unordered_map>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Fitting = CGAL::Monge_via_jet_fitting<Kernel>;
using Point = std::array<float, 3>;

struct Hash {
    size_t operator()(const Point& p) const {
        uint32_t bits[3];
        std::memcpy(bits, p.data(), 12);
        return (bits[0] * 0x9e3779b97f4a7c15u ^ bits[1]) * 0xd6e8feb86659fd93u ^ bits[2] * 0xc2b2ae3d27d4eb4fu;
    }
};

struct Mesh {
    std::vector<Point> points;
    std::vector<std::array<int, 3>> faces;
};

static bool read(const char* path, Mesh& mesh) {
    FILE* file = std::fopen(path, "rb");
    if (!file) return false;
    unsigned char header[84];
    bool good = std::fread(header, 84, 1, file) == 1;
    uint32_t count = 0;
    if (good) std::memcpy(&count, header + 80, 4);
    std::vector<unsigned char> body(50 * size_t(count));
    good = good && std::fread(body.data(), 1, body.size(), file) == body.size();
    std::fclose(file);
    if (!good) return false;
    std::unordered_map<Point, int, Hash> number;
    number.reserve(count / 2 + 1);
    mesh.faces.resize(count);
    for (size_t f = 0; f < count; f++)
        for (int i = 0; i < 3; i++) {
            Point p;
            std::memcpy(p.data(), &body[50 * f + 12 + 12 * i], 12);
            auto [at, is_new] = number.try_emplace(p, int(mesh.points.size()));
            if (is_new) mesh.points.push_back(p);
            mesh.faces[f][i] = at->second;
        }
    return true;
}

// Neighbours of every vertex, each once or twice, in one array.
struct Neighbours {
    std::vector<size_t> first;
    std::vector<int> of;

    explicit Neighbours(const Mesh& mesh) : first(mesh.points.size() + 1), of(6 * mesh.faces.size()) {
        for (auto& face : mesh.faces)
            for (int v : face) first[v + 1] += 2;
        for (size_t v = 0; v < mesh.points.size(); v++) first[v + 1] += first[v];
        std::vector<size_t> next(first.begin(), first.end() - 1);
        for (auto& face : mesh.faces)
            for (int i = 0; i < 3; i++) {
                of[next[face[i]]++] = face[(i + 1) % 3];
                of[next[face[i]]++] = face[(i + 2) % 3];
            }
    }
};

int main(int argc, char** argv) {
    if (argc != 5) return std::fprintf(stderr, "usage: cgal_jets IN.stl OUT.bin DEGREE RINGS\n"), 2;
    const int degree = std::atoi(argv[3]), rings = std::atoi(argv[4]);
    const size_t needed = size_t(degree + 1) * (degree + 2) / 2;
    Mesh mesh;
    if (!read(argv[1], mesh)) return std::fprintf(stderr, "%s: cannot be read\n", argv[1]), 1;
    auto start = std::chrono::steady_clock::now();
    const size_t count = mesh.points.size();
    Neighbours neighbours(mesh);
    std::vector<std::array<double, 3>> normals(count, {0, 0, 0});
    for (auto& face : mesh.faces) {
        double u[3], v[3];
        for (int i = 0; i < 3; i++) {
            u[i] = double(mesh.points[face[1]][i]) - mesh.points[face[0]][i];
            v[i] = double(mesh.points[face[2]][i]) - mesh.points[face[0]][i];
        }
        for (int i = 0; i < 3; i++)
            for (int corner : face)
                normals[corner][i] += u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    }
    std::vector<int> seen(count, -1), window;
    std::vector<std::array<double, 2>> curvatures(count, {NAN, NAN});
    std::vector<Kernel::Point_3> samples;
    for (size_t v = 0; v < count; v++) {
        window.assign(1, int(v));
        seen[v] = int(v);
        size_t begin = 0;
        for (int ring = 0; ring < rings || window.size() < needed + 2; ring++) {
            const size_t end = window.size();
            if (begin == end) break;
            for (size_t i = begin; i < end; i++)
                for (size_t n = neighbours.first[window[i]]; n < neighbours.first[window[i] + 1]; n++) {
                    const int other = neighbours.of[n];
                    if (seen[other] == int(v)) continue;
                    seen[other] = int(v);
                    window.push_back(other);
                }
            begin = end;
        }
        if (window.size() < needed) continue;
        samples.clear();
        for (int w : window) samples.emplace_back(mesh.points[w][0], mesh.points[w][1], mesh.points[w][2]);
        Fitting fitting;
        auto form = fitting(samples.begin(), samples.end(), degree, degree < 2 ? 2 : degree);
        form.comply_wrt_given_normal(Kernel::Vector_3(normals[v][0], normals[v][1], normals[v][2]));
        // CGAL counts a surface that bends towards its normal as positive.
        curvatures[v] = {-form.principal_curvatures(1), -form.principal_curvatures(0)};
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    FILE* out = std::fopen(argv[2], "wb");
    if (!out || std::fwrite(curvatures.data(), 16, count, out) != count || std::fclose(out) != 0)
        return std::fprintf(stderr, "%s: cannot be written\n", argv[2]), 1;
    std::printf("%f\n", seconds);
}
