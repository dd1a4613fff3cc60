// Reports in a headless Chromium, which complain when anything goes wrong.
import { pathToFileURL } from "node:url";
import { launch as launchPlain } from "../clients/browser.mjs";

export const launch = (path) => launchPlain(path, ["--js-flags=--expose-gc", "--enable-precise-memory-info"]);

export const DESKTOP = { width: 1280, height: 800, deviceScaleFactor: 1 };
export const PHONE = { width: 390, height: 844, deviceScaleFactor: 2, isMobile: true, hasTouch: true };

// Opens a report from disk, as a person would, and waits until it is drawn. Errors, warnings and requests for
// anything but the page itself are kept in `page.complaints`.
export async function open(browser, file, viewport = DESKTOP, scheme = "light") {
  const page = await browser.newPage();
  page.complaints = [];
  page.on("console", (m) => ["error", "warn"].includes(m.type()) && page.complaints.push(m.text()));
  page.on("pageerror", (error) => page.complaints.push(`${error}`));
  page.on("request", (r) => /^(file|data|blob):/.test(r.url()) || page.complaints.push(`requests ${r.url()}`));
  page.on("dialog", async (dialog) => {
    page.complaints.push(`says ${dialog.message()}`);
    await dialog.dismiss();
  });
  await page.setViewport(viewport);
  await page.emulateMediaFeatures([
    { name: "prefers-color-scheme", value: scheme },
    { name: "prefers-reduced-motion", value: "reduce" },
  ]);
  const start = Date.now();
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector("body[data-ready]", { timeout: 120_000 });
  page.seconds = (Date.now() - start) / 1000;
  return page;
}

// Lets everything that was asked for be drawn.
export const settled = (page) =>
  page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// Face number (from 1), red, green, blue of every pixel of the view, drawn without light or lines.
export async function pixels(page) {
  return page.evaluate(() => {
    const { view, camera, look } = window.osculate;
    const plain = { ...look, shading: "unlit", edges: new Float32Array(16), strokes: "none", wire: false, isSelecting: false };
    plain.pointed = plain.chosen = { model: -1, face: -1 };
    const { gl, canvas } = view;
    const [w, h] = [canvas.width, canvas.height];
    const faces = view.facesIn(camera, plain, 0, 0, w, h);
    view.draw(camera, plain);
    const colors = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, colors);
    const found = [];
    for (let y = 1; y < h - 1; y++) {
      for (let x = 1; x < w - 1; x++) {
        const i = y * w + x;
        const own = faces[4 * i];
        // Only where the neighbours show the same face: borders are blended.
        if (own > 0 && [i - 1, i + 1, i - w, i + w].every((n) => faces[4 * n] === own)) {
          found.push([own - 1, colors[4 * i], colors[4 * i + 1], colors[4 * i + 2], x, y]);
        }
      }
    }
    return found;
  });
}
