// Where setup.sh puts the npm packages, and how client tests speak (results.py).
import { homedir } from "node:os";
import { join } from "node:path";

const cache = process.env.XDG_CACHE_HOME || join(homedir(), ".cache");
export const packages = process.env.OSCULATE_NPM || join(cache, "osculate", "npm");

export function say(client, file, check, result, detail = "") {
  console.log(JSON.stringify({ client, file, check, result, detail }));
}
