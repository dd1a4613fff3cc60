use osculate::synth::*;
use osculate::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let factor: f64 = args.get(1).map_or(3.0, |s| s.parse().unwrap());
    for (name, surface, u, v) in [
        ("torus120x48", Surface::Torus { major: 3.0, minor: 1.0 }, 120, 48),
        ("torus60x24", Surface::Torus { major: 3.0, minor: 1.0 }, 60, 24),
        ("sphere", Surface::Sphere { radius: 2.0 }, 64, 32),
        ("cyl", Surface::Cylinder { radius: 10.0, height: 20.0 }, 64, 20),
        ("rimcyl", Surface::Cylinder { radius: 10.0, height: 20.0 }, 48, 1),
        ("saddle", Surface::Saddle, 50, 50),
        ("monkey", Surface::MonkeySaddle, 50, 50),
        ("plane", Surface::Plane, 5, 5),
    ] {
        let (soup, exact) = Grid::new(surface, u, v).build();
        let t = std::time::Instant::now();
        let mesh = Mesh::from_soup(&soup, &MeshOptions::default()).unwrap();
        let t1 = t.elapsed();
        for est in [Estimator::Osculating, Estimator::Osculating3] {
            let t = std::time::Instant::now();
            let opt = CurvatureOptions { estimator: est, radius: Radius::FaceFactor(factor), ..Default::default() };
            let values = estimate(&mesh, &opt, &NoProgress).unwrap();
            let dt = t.elapsed();
            let mut e1 = vec![];
            let mut e2 = vec![];
            let mut ek = vec![];
            let mut ep = vec![];
            let mut dir = vec![];
            for (v, x) in values.iter().zip(&exact) {
                let s = x.k_max.abs().max(x.k_min.abs()).max(1e-9);
                e1.push((v.k_max as f64 - x.k_max).abs() / s * 100.0);
                e2.push((v.k_min as f64 - x.k_min).abs() / s * 100.0);
                let kk = (x.k_max * x.k_min).abs().max(1e-9);
                let kk2 = s * s;
                let _ = kk;
                ek.push((v.gauss() as f64 - x.k_max * x.k_min).abs() / kk2 * 100.0);
                ep.push((v.gauss_perimeter as f64 - x.k_max * x.k_min).abs() / kk2 * 100.0);
                dir.push(v.dir_max.as_dvec3().dot(x.dir_max).abs().min(1.0).acos().to_degrees());
            }
            let q = |v: &mut Vec<f64>| {
                v.sort_by(f64::total_cmp);
                format!("{:8.3}/{:8.3}", v[v.len() / 2], v[v.len() * 95 / 100])
            };
            println!(
                "{name:12} {est:?}: kmax {} kmin {} K {} Kp {} dir {} {:.2}us mesh {:?}",
                q(&mut e1),
                q(&mut e2),
                q(&mut ek),
                q(&mut ep),
                q(&mut dir),
                dt.as_secs_f64() * 1e6 / values.len() as f64,
                t1
            );
        }
    }
}
