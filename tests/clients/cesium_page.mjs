// In the browser: loads a file, gives the rows of its table, and picks faces.
const { Cesium } = window;
const SIZE = 512;
const widget = new Cesium.CesiumWidget("view", {
  baseLayer: false, globe: false, skyBox: false, skyAtmosphere: false, useDefaultRenderLoop: false,
});
const { scene, camera } = widget;

async function drawn(done) {
  for (let frame = 0; frame < 2000 && !done(); frame++) {
    scene.initializeFrame();
    scene.render();
    await new Promise((next) => setTimeout(next, 5));
  }
  if (!done()) throw new Error("does not get ready");
}

window.load = (name, columns) => load(name, columns).catch((error) => {
  throw new Error(error.message);
});

async function load(name, columns) {
  scene.primitives.removeAll();
  const model = scene.primitives.add(await Cesium.Model.fromGltfAsync({ url: `/${name}` }));
  await drawn(() => model.ready);
  const { structuralMetadata } = model.sceneGraph.components;
  const tables = structuralMetadata.propertyTables;
  const own = tables.find((table) => table.class.id === "osculate_face");
  const row = (at, get) => columns.map((column) => get(at, column));
  const table = Array.from({ length: own.count }, (_, i) => row(i, (at, column) => own.getProperty(at, column)));

  const { center, radius } = model.boundingSphere;
  const [away, up] = [new Cesium.Cartesian3(0.45, 0.55, 0.7), new Cesium.Cartesian3(0, 0, 1)];
  const position = Cesium.Cartesian3.add(center, Cesium.Cartesian3.multiplyByScalar(away, 2.5 * radius, new Cesium.Cartesian3()), new Cesium.Cartesian3());
  const direction = Cesium.Cartesian3.normalize(Cesium.Cartesian3.subtract(center, position, new Cesium.Cartesian3()), new Cesium.Cartesian3());
  const right = Cesium.Cartesian3.normalize(Cesium.Cartesian3.cross(direction, up, new Cesium.Cartesian3()), new Cesium.Cartesian3());
  camera.setView({ destination: position, orientation: { direction, up: Cesium.Cartesian3.cross(right, direction, new Cesium.Cartesian3()) } });
  let frames = 0;
  await drawn(() => ++frames > 3);
  const picked = [];
  for (let y = 16; y < SIZE; y += 16) {
    for (let x = 16; x < SIZE; x += 16) {
      const feature = scene.pick(new Cesium.Cartesian2(x, y));
      if (feature?.featureId !== undefined) {
        picked.push([feature.featureId, columns.map((column) => feature.getProperty(column))]);
      }
    }
  }
  return { table, picked };
}
window.ready = true;
