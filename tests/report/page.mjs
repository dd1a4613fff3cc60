// The report in headless Chromium, against what the program writes as CSV and PLY.
// usage: node page.mjs FOLDER SCREENSHOTS [CHROMIUM]
import assert from "node:assert/strict";
import { readdir, readFile } from "node:fs/promises";
import { join, resolve } from "node:path";
import { launch, open, pixels, settled, DESKTOP, PHONE } from "./browser.mjs";
import { colors, rows } from "../clients/tables.mjs";

const [folder, screenshots, chromium] = process.argv.slice(2).map((path) => resolve(path));
const browser = await launch(chromium);
let failed = 0;

async function check(what, test) {
  const start = Date.now();
  try {
    const said = await test();
    console.log(`ok    ${what}${said ? `: ${said}` : ""} (${((Date.now() - start) / 1000).toFixed(1)} s)`);
  } catch (error) {
    failed++;
    console.log(`WRONG ${what}: ${error.stack ?? error}`);
  }
  for (const page of await browser.pages()) if (page.url() !== "about:blank") await page.close();
}

const file = (name) => join(folder, name);
const number = (text) => Number(text.replace(/[\u202f\s]/g, "").replace("−", "-").replace(/·10(.*)/, (_, p) => `e${[...p].map((c) => "-0123456789"["⁻⁰¹²³⁴⁵⁶⁷⁸⁹".indexOf(c)]).join("")}`));
const quiet = (page) => assert.deepEqual(page.complaints, []);
const selected = (page) => page.$eval("#selected", (e) => Number(e.dataset.count));
const single = (text) => Math.fround(Number(text));

await check("every page opens without a complaint", async () => {
  const pages = (await readdir(folder)).filter((name) => name.endsWith(".html") && !name.startsWith("large"));
  for (const name of pages) {
    const page = await open(browser, file(name));
    assert.deepEqual(page.complaints, [], name);
    const shown = await pixels(page);
    assert.ok(shown.length > 500, `${name} shows ${shown.length} pixels`);
    await page.close();
  }
  return `${pages.length} pages`;
});

await check("faces have the palette's colours", async () => {
  const page = await open(browser, file("part.html"));
  let most = 0;
  let count = 0;
  for (const [quantity, ply] of [["mean", "part.ply"], ["k_max", "part-k_max.ply"], ["class", "part-class.ply"]]) {
    const wanted = await colors(file(ply));
    for (const view of ["iso", "x", "z"]) {
      await page.evaluate((q, v) => {
        window.osculate.state.show(q);
        window.osculate.fit(v);
      }, quantity, view);
      await settled(page);
      for (const [face, r, g, b] of await pixels(page)) {
        count++;
        const far = Math.max(...[r, g, b].map((c, i) => Math.abs(c - wanted[face][i])));
        assert.ok(far <= 3, `${quantity}, face ${face}: ${[r, g, b]} is not ${wanted[face]}`);
        most = Math.max(most, far);
      }
    }
  }
  quiet(page);
  return `${count} pixels within ${most} of 255`;
});

await check("hovering tells the CSV's values", async () => {
  const page = await open(browser, file("part.html"));
  const csv = await rows(file("part.csv"));
  const seen = await pixels(page);
  const box = await (await page.$("#view")).boundingBox();
  for (const share of [0.1, 0.35, 0.6, 0.85]) {
    const [face, , , , x, y] = seen[Math.floor(share * seen.length)];
    await page.mouse.move(box.x + x + 0.5, box.y + box.height - y - 0.5);
    await page.waitForFunction((f) => window.osculate.state.pointed.face === f, {}, face);
    await settled(page);
    const told = await page.$$eval("#face [data-value]", (all) => Object.fromEntries(all.map((e) => [e.dataset.value, e.textContent])));
    assert.equal(number(told.number), face);
    for (const name of ["k_max", "k_min", "mean", "gauss", "radius", "coverage", "confidence"]) {
      const [is, wanted] = [number(told[name].split(" ")[0]), Number(csv[face][name])];
      // Four digits are shown, two of coverage and confidence, which are kept in a byte.
      const near = ["coverage", "confidence"].includes(name) ? 0.008 : 6e-4 * Math.abs(wanted) + 1e-12;
      assert.ok(Math.abs(is - wanted) <= near, `face ${face}: ${name} ${told[name]} is not ${csv[face][name]}`);
    }
    const disk = await page.evaluate(() => window.osculate.view.parts[0].disk.length);
    assert.ok(disk >= 24, "the disk is drawn");
  }
  quiet(page);
});

await check("the range's handles change what is shown", async () => {
  const page = await open(browser, file("part.html"));
  const sum = async () => (await pixels(page)).reduce((s, [, r, g, b]) => s + r + 3 * g + 7 * b, 0);
  const before = [await sum(), await page.evaluate(() => window.osculate.state.range)];
  const box = await (await page.$('[data-end="high"]')).boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x - 60, box.y + 40, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const dragged = [await sum(), await page.evaluate(() => window.osculate.state.range)];
  assert.ok(dragged[1][1] < before[1][1] && dragged[0] !== before[0]);
  await page.focus('[data-end="low"]');
  await page.keyboard.press("ArrowRight");
  await settled(page);
  const keyed = await page.evaluate(() => window.osculate.state.range);
  assert.ok(keyed[0] > dragged[1][0], "keys move a handle too");
  quiet(page);
});

await check("brushes select the faces that a query on the CSV finds", async () => {
  const page = await open(browser, file("part.html"));
  const csv = await rows(file("part.csv"));
  const drag = async (selector, from, to) => {
    const element = await page.$(selector);
    await element.evaluate((e) => e.scrollIntoView({ block: "center" }));
    await settled(page);
    const box = await element.boundingBox();
    const at = ([x, y]) => [box.x + x * box.width, box.y + y * box.height];
    await page.mouse.move(...at(from));
    await page.mouse.down();
    await page.mouse.move(...at(to), { steps: 3 });
    await page.mouse.up();
    await settled(page);
    const bounds = await page.evaluate(() =>
      Object.entries(window.osculate.state.bounds).map(([name, b]) => [name, b.map((v) => (Number.isFinite(v) ? v : v > 0 ? 1e300 : -1e300))]));
    return [await selected(page), bounds];
  };
  const query = (bounds) => csv.filter((row) => bounds.every(([name, [low, high]]) => row[name] !== "" && single(row[name]) >= low && single(row[name]) <= high)).length;
  const counts = [];
  for (const [selector, from, to] of [
    ["#panel section:nth-of-type(1) .plot canvas", [0.52, 0.4], [0.9, 0.5]],
    ["#panel section:nth-of-type(4) figure:nth-of-type(1) canvas", [0.3, 0.2], [0.7, 0.6]],
    ["#panel section:nth-of-type(4) figure:nth-of-type(2) canvas", [0.5, 0.1], [0.95, 0.8]],
  ]) {
    const [count, bounds] = await drag(selector, from, to);
    assert.equal(count, query(bounds), JSON.stringify(bounds));
    assert.ok(count > 0);
    counts.push(count);
  }
  // In the view: exactly the faces that are seen there.
  await page.click("#brush");
  const box = await (await page.$("#view")).boundingBox();
  const seen = await page.evaluate(() => {
    const { view, camera, look } = window.osculate;
    const [w, h] = [view.canvas.width, view.canvas.height];
    const all = view.facesIn(camera, look, Math.floor(w * 0.3), Math.floor(h * 0.3), Math.floor(w * 0.4), Math.floor(h * 0.4));
    return new Set(all.filter((n, i) => i % 4 === 0 && n > 0)).size;
  });
  await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.3 * box.height);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.7 * box.width, box.y + 0.7 * box.height, { steps: 3 });
  await page.mouse.up();
  await settled(page);
  const count = await selected(page);
  assert.ok(Math.abs(count - seen) <= 0.02 * seen, `${count} of ${seen}`);
  quiet(page);
  return `${counts.join(", ")} faces, ${count} seen`;
});

await check("the selection is saved as CSV with the program's numbers", async () => {
  const page = await open(browser, file("part.html"));
  const csv = await rows(file("part.csv"));
  await page.evaluate(() => {
    window.saved = null;
    const { createObjectURL } = URL;
    URL.createObjectURL = (blob) => {
      window.saved = blob;
      return createObjectURL.call(URL, blob);
    };
    window.osculate.state.select("even", (_, f) => f % 2 === 0);
  });
  await settled(page);
  await page.click("#csv");
  const lines = (await page.evaluate(() => window.saved.text())).trim().split("\n").map((l) => l.split(","));
  const [head, ...body] = lines;
  assert.equal(body.length, Math.ceil(csv.length / 2));
  for (const line of body) {
    const row = Object.fromEntries(head.map((name, i) => [name, line[i]]));
    const wanted = csv[Number(row.face)];
    for (const name of ["class", "k_max", "k_min", "mean"]) assert.equal(single(row[name]), single(wanted[name]), `${name} of face ${row.face}`);
  }
  await page.click("#save");
  await page.waitForFunction(() => window.saved.type === "image/png");
  const size = await page.evaluate(async () => {
    const image = await createImageBitmap(window.saved);
    return [image.width, image.height, window.osculate.view.canvas.width];
  });
  assert.ok(size[0] === size[2] && size[1] > 300, `the picture is ${size}`);
  quiet(page);
  return `${body.length} rows`;
});

await check("keys turn, zoom and choose views", async () => {
  const page = await open(browser, file("part.html"));
  const camera = () => page.evaluate(() => ({ yaw: osculate.camera.yaw, pitch: osculate.camera.pitch, distance: osculate.camera.distance }));
  await page.focus("#view");
  const start = await camera();
  await page.keyboard.press("ArrowLeft");
  const turned = await camera();
  assert.ok(turned.yaw !== start.yaw);
  await page.keyboard.press("+");
  assert.ok((await camera()).distance < start.distance);
  await page.keyboard.press("z");
  assert.ok(Math.abs((await camera()).pitch - Math.PI / 2) < 1e-9);
  // Everything that can be worked is reached with the tab key and has a name.
  const nameless = await page.$$eval("button, select, input, [role=slider], canvas[tabindex]", (all) =>
    all.filter((e) => e.offsetParent !== null && !(e.textContent.trim() || e.ariaLabel || e.labels?.[0]?.textContent.trim())).map((e) => e.outerHTML));
  assert.deepEqual(nameless, []);
  quiet(page);
});

await check("touch turns, pinches and taps", async () => {
  const page = await open(browser, file("part.html"), PHONE);
  const box = await (await page.$("#view")).boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const camera = () => page.evaluate(() => [osculate.camera.yaw, osculate.camera.distance]);
  const [yaw, distance] = await camera();
  await page.touchscreen.touchStart(x, y);
  for (let i = 1; i <= 5; i++) await page.touchscreen.touchMove(x + 12 * i, y);
  await page.touchscreen.touchEnd();
  assert.ok((await camera())[0] !== yaw, "a finger turns");
  const session = await page.createCDPSession();
  const touch = (type, gap) =>
    session.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x: x - gap, y, id: 1 }, { x: x + gap, y, id: 2 }] });
  await touch("touchStart", 30);
  for (const gap of [40, 55, 70, 90]) await touch("touchMove", gap);
  await touch("touchEnd");
  const near = (await camera())[1];
  assert.ok(near < 0.6 * distance, `two fingers zoom: ${distance} to ${near}`);
  const seen = await pixels(page);
  const [face, , , , px, py] = seen[seen.length >> 1];
  await page.touchscreen.tap(box.x + px / 2 + 0.25, box.y + box.height - py / 2 - 0.25);
  await settled(page);
  const chosen = await page.evaluate(() => osculate.state.chosen.face);
  assert.equal(chosen, face);
  assert.match(await page.$eval("#face", (e) => e.textContent), /Face/);
  quiet(page);
});

await check("both themes, a phone and a desk", async () => {
  const papers = [];
  for (const name of ["part", "pair", "scan"]) {
    for (const scheme of ["light", "dark"]) {
      for (const [device, viewport] of [["desk", DESKTOP], ["phone", PHONE]]) {
        const page = await open(browser, file(`${name}.html`), viewport, scheme);
        await settled(page);
        papers.push(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
        const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        assert.ok(wide <= 0, `${name} is ${wide} pixels too wide on a ${device}`);
        await page.screenshot({ path: join(screenshots, `${name}-${device}-${scheme}.png`) });
        quiet(page);
        await page.close();
      }
    }
  }
  assert.equal(new Set(papers).size, 2);
  const page = await open(browser, file("part.html"));
  await page.click("#theme");
  await settled(page);
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), papers[2], "the button does it too");
  // Twice as large: nothing is cut off or lies over something else's place.
  await page.setViewport({ ...DESKTOP, width: DESKTOP.width / 2, height: DESKTOP.height / 2, deviceScaleFactor: 2 });
  await settled(page);
  assert.ok((await page.evaluate(() => document.documentElement.scrollWidth - innerWidth)) <= 0);
  quiet(page);
});

await check("hostile names are shown and do nothing", async () => {
  const page = await open(browser, file("hostile.html"));
  assert.equal(await page.evaluate(() => window.hacked), undefined);
  assert.equal(await page.$("#panel img, header img"), null);
  const text = await page.$eval("#panel", (e) => e.textContent);
  assert.ok(text.includes("</script><script>window.hacked=1</script>"));
  assert.ok(!/[\u202a-\u202e\u2066-\u2069]/.test(text + (await page.title())));
  quiet(page);
});

await check("a mesh without any estimate says why", async () => {
  const page = await open(browser, file("tiny.html"));
  assert.match(await page.$eval("#sentences", (e) => e.textContent), /No face has an estimate/);
  quiet(page);
});

await check("two meshes share the camera and the scale", async () => {
  const page = await open(browser, file("pair.html"));
  const both = await page.evaluate(() => osculate.view.panes.map((p) => [p.width, p.height]));
  assert.deepEqual(both[0], both[1]);
  const { width } = await (await page.$("#view")).boundingBox();
  const seen = await pixels(page);
  const [left, right] = [seen.filter((p) => p[4] < width / 2).length, seen.filter((p) => p[4] >= width / 2).length];
  assert.ok(Math.abs(left - right) < 0.02 * left, `${left} and ${right} pixels of the same mesh`);
  assert.equal((await page.$$("#percentiles table")).length, 2);
  // The same faces can be subtracted.
  const [a, b] = [await rows(file("a.csv")), await rows(file("b.csv"))];
  const differences = await page.evaluate(() => {
    osculate.state.subtract(true);
    return Array.from(osculate.state.values[0]);
  });
  differences.forEach((d, f) => {
    const wanted = Number(b[f].mean) - Number(a[f].mean);
    assert.ok(Math.abs(d - wanted) <= 1e-6 * (Math.abs(a[f].mean) + Math.abs(b[f].mean)), `face ${f}: ${d}, not ${wanted}`);
  });
  await settled(page);
  assert.match(await page.$eval("#legend-title", (e) => e.textContent), /B − A/);
  quiet(page);
});

await check("a thinned mesh says so and keeps its numbers", async () => {
  const page = await open(browser, file("thin.html"));
  const csv = await rows(file("thin.csv"));
  assert.match(await page.$eval("#sentences", (e) => e.textContent), /Thinned for display/);
  const kept = await page.evaluate(() => {
    const [m] = osculate.models ?? osculate.state.models;
    return Array.from(m.numbers, (n, i) => [n, m.k_max[i], m.k_min[i]]);
  });
  assert.ok(kept.length < csv.length && kept.length > 500);
  for (const [n, k_max, k_min] of kept) {
    assert.equal(k_max, single(csv[n].k_max));
    assert.equal(k_min, single(csv[n].k_min));
  }
  quiet(page);
  return `${kept.length} of ${csv.length} faces`;
});

await check("memory does not grow over a hundred quantities", async () => {
  const page = await open(browser, file("scan.html"));
  const heap = () => page.evaluate(async () => {
    for (let i = 0; i < 3; i++) {
      window.gc();
      await new Promise((done) => setTimeout(done, 50));
    }
    return performance.memory.usedJSHeapSize;
  });
  const names = await page.evaluate(() => osculate.state.definitions.map((d) => d.name));
  const turn = async (times) => {
    for (let i = 0; i < times; i++) await page.evaluate((name) => new Promise((done) => {
      osculate.state.show(name);
      requestAnimationFrame(done);
    }), names[i % names.length]);
  };
  await turn(2 * names.length);
  const before = await heap();
  await turn(100);
  const grown = (await heap()) - before;
  assert.ok(grown < 1e6, `${grown} bytes more`);
  quiet(page);
  return `${grown} bytes more`;
});

await check("200 000 faces load in under 5 s", async () => {
  // The best of six at most: what else the machine does is not the page's time.
  let page = null;
  let seconds = Infinity;
  for (let i = 0; i < 6 && seconds >= 5; i++) {
    await page?.close();
    page = await open(browser, file("large.html"));
    seconds = Math.min(seconds, page.seconds);
  }
  const size = (await readFile(file("large.html"))).length;
  const [frame, gpu] = await page.evaluate(() => {
    const { draw, camera, view } = osculate;
    // Waits for the pictures themselves.
    const wait = () => view.gl.readPixels(0, 0, 1, 1, view.gl.RGBA, view.gl.UNSIGNED_BYTE, new Uint8Array(4));
    const frames = 10;
    wait();
    const start = performance.now();
    for (let i = 0; i < frames; i++) {
      camera.rotate(0.02, 0);
      draw();
    }
    const script = performance.now() - start;
    wait();
    return [script / frames, (performance.now() - start) / frames];
  });
  assert.ok(seconds < 5, `${seconds} s`);
  assert.ok(frame < 2, `${frame} ms of script a frame`);
  quiet(page);
  return `${seconds.toFixed(1)} s, ${(size / 200000).toFixed(1)} bytes a face, ${frame.toFixed(2)} ms of script a frame, ${gpu.toFixed(0)} ms with software graphics`;
});

await browser.close();
process.exit(failed > 0 ? 1 : 0);
