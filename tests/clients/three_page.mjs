// In the browser: loads a file, gives its values by face, renders its looks without light.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { MeshoptDecoder } from "three/addons/libs/meshopt_decoder.module.js";

const SIZE = 512;
const canvas = document.getElementById("c");
const renderer = new THREE.WebGLRenderer({ canvas, antialias: false, preserveDrawingBuffer: true });
renderer.setSize(SIZE, SIZE, false);
renderer.outputColorSpace = THREE.SRGBColorSpace;
let gltf;

function meshes() {
  const found = [];
  gltf.scene.traverse((object) => object.isMesh && object.geometry.attributes._face_id && found.push(object));
  return found;
}

// One value per face of each attribute, in the order of face numbers; NaN where corners differ.
window.load = async (name) => {
  gltf = await new GLTFLoader().setMeshoptDecoder(MeshoptDecoder).loadAsync(`/${name}`);
  gltf.scene.updateMatrixWorld(true);
  const values = {};
  for (const mesh of meshes()) {
    const { index, attributes } = mesh.geometry;
    const count = index ? index.count : attributes.position.count;
    for (const name of Object.keys(attributes).filter((name) => name.startsWith("_"))) {
      values[name] ??= [];
      for (let corner = 0; corner < count; corner += 3) {
        const at = [0, 1, 2].map((c) => (index ? index.getX(corner + c) : corner + c));
        const [a, b, c] = at.map((vertex) => attributes[name].getX(vertex));
        values[name][attributes._face_id.getX(at[0])] = a === b && b === c ? a : NaN;
      }
    }
  }
  return values;
};

async function material(mesh, variant) {
  if (variant === null) return mesh.material;
  const names = gltf.userData.gltfExtensions.KHR_materials_variants.variants.map((v) => v.name);
  const mappings = mesh.userData.gltfExtensions.KHR_materials_variants.mappings;
  const mapping = mappings.find((m) => m.variants.includes(names.indexOf(variant)));
  const material = await gltf.parser.getDependency("material", mapping.material);
  const copy = { material, isMesh: true, geometry: mesh.geometry };
  gltf.parser.assignFinalMaterial(copy);
  return copy.material;
}

function render(scene, camera) {
  renderer.render(scene, camera);
  const pixels = new Uint8Array(4 * SIZE * SIZE);
  renderer.getContext().readPixels(0, 0, SIZE, SIZE, WebGL2RenderingContext.RGBA, WebGL2RenderingContext.UNSIGNED_BYTE, pixels);
  return pixels;
}

// Face, red, green and blue of every pixel whose neighbours show the same face.
window.show = async (variant) => {
  const [colors, numbers] = [new THREE.Scene(), new THREE.Scene()];
  for (const mesh of meshes()) {
    const look = await material(mesh, variant);
    const plain = new THREE.MeshBasicMaterial({ map: look.map, color: look.color, vertexColors: look.vertexColors, side: THREE.DoubleSide });
    const number = new THREE.ShaderMaterial({
      side: THREE.DoubleSide,
      vertexShader: `attribute float _face_id; flat varying float id;
        void main() { id = _face_id + 1.0; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
      fragmentShader: `flat varying float id;
        void main() { gl_FragColor = vec4(mod(id, 256.0) / 255.0, floor(id / 256.0) / 255.0, 0.0, 1.0); }`,
    });
    number.toneMapped = false;
    for (const [scene, material] of [[colors, plain], [numbers, number]]) {
      const copy = new THREE.Mesh(mesh.geometry, material);
      copy.matrixAutoUpdate = false;
      copy.matrix.copy(mesh.matrixWorld);
      copy.frustumCulled = false;
      scene.add(copy);
    }
  }
  colors.updateMatrixWorld(true);
  const box = new THREE.Box3().setFromObject(colors);
  const [center, radius] = [box.getCenter(new THREE.Vector3()), box.getSize(new THREE.Vector3()).length() / 2];
  const camera = new THREE.OrthographicCamera(-radius, radius, radius, -radius, 0, 4 * radius);
  camera.position.copy(center).add(new THREE.Vector3(0.5, 0.6, 1).normalize().multiplyScalar(2 * radius));
  camera.lookAt(center);
  const faces = render(numbers, camera);
  const shown = render(colors, camera);
  const face = (i) => faces[4 * i] + 256 * faces[4 * i + 1] - 1;
  const seen = [];
  for (let i = SIZE; i < SIZE * (SIZE - 1); i++) {
    const own = face(i);
    if (own >= 0 && [i - 1, i + 1, i - SIZE, i + SIZE].every((n) => face(n) === own)) {
      seen.push([own, shown[4 * i], shown[4 * i + 1], shown[4 * i + 2]]);
    }
  }
  return seen;
};
window.ready = true;
