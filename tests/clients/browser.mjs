// A headless Chromium with software graphics, and a server for pages that fetch what they show.
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { extname, join, normalize } from "node:path";
import { packages } from "./packages.mjs";

const require = createRequire(join(packages, "package.json"));
const puppeteer = (await import(require.resolve("puppeteer-core"))).default;

export function launch(path, more = []) {
  return puppeteer.launch({
    executablePath: path ?? "/usr/bin/chromium",
    protocolTimeout: 600_000,
    args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", ...more],
  });
}

const KINDS = {
  ".css": "text/css", ".html": "text/html", ".js": "text/javascript", ".json": "application/json",
  ".mjs": "text/javascript", ".png": "image/png", ".wasm": "application/wasm",
};

// Serves `page` as `/`, the file `module` as `/page.mjs`, a library's files from below `root` where paths begin
// with `library`, and everything else from `folder`. Gives the address.
export async function serve({ page, module, library, root, folder }) {
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(request.url.split("?")[0]));
    try {
      const body =
        path === "/" ? page
        : await readFile(path === "/page.mjs" ? module : join(path.startsWith(library) ? root : folder, path));
      const kind = path === "/" ? "text/html" : KINDS[extname(path)];
      response.writeHead(200, { "content-type": kind ?? "application/octet-stream" }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  }).listen(0, "127.0.0.1");
  await new Promise((done) => server.once("listening", done));
  return { server, address: `http://127.0.0.1:${server.address().port}/` };
}
