// Builds the page into ../static: the same sources give the same bytes. `node build.mjs --watch` builds again on
// every change; `node build.mjs --check` says whether what is there is what would be built.
import { createHash } from "node:crypto";
import { cp, mkdir, mkdtemp, readFile, readdir, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const HERE = dirname(fileURLToPath(import.meta.url));
const KEPT = join(HERE, "..", "static");
const OUT = process.argv.includes("--watch") ? KEPT : await mkdtemp(join(tmpdir(), "bentod-page-"));
const SHIPPED = ["three", "urdf-loader", "uplot", "@msgpack/msgpack"];
const SOURCES = ["index.html", "package.json", "package-lock.json", "build.mjs", "src", "models"];

const UNUSED = /(physical|transmission|iridescence|toon|matcap)\w*\.glsl\.js$/; // no material of scene_*.js needs them

/** Keeps the page small: three from its modules, its shaders without comments, and no loaders of meshes. */
function lean(build) {
  build.onResolve({ filter: /^three$/ }, () => ({ path: join(HERE, "node_modules/three/src/Three.js"), sideEffects: false }));
  build.onResolve({ filter: /\/(Collada|STL)Loader\.js$/ }, () => ({ path: join(HERE, "src/scene_no_meshes.js") }));
  build.onLoad({ filter: UNUSED }, async ({ path }) => ({
    contents: (await readFile(path, "utf8")).replace(/`[^`]*`/g, '""'),
  }));
  build.onLoad({ filter: /\.glsl\.js$/ }, async ({ path }) => {
    const shader = await readFile(path, "utf8");
    const bare = shader.replace(/\/\/.*$/gm, "").replace(/\/\*[^]*?\*\//g, "");
    return { contents: bare.replace(/[ \t]+/g, " ").replace(/\n[\s]+/g, "\n") };
  });
}

const options = {
  absWorkingDir: HERE,
  entryPoints: { page: "src/main.js" },
  outdir: OUT,
  bundle: true,
  format: "esm",
  target: ["es2022", "chrome109", "firefox115", "safari16"],
  minify: true,
  plugins: [{ name: "lean", setup: lean }],
  legalComments: "none", // licences.txt has the whole texts
  logLevel: "warning",
};

async function files(path) {
  const entries = await readdir(path, { withFileTypes: true, recursive: true });
  return entries.filter((entry) => entry.isFile()).map((entry) => join(entry.parentPath ?? entry.path, entry.name));
}

async function sources() {
  const found = [];
  for (const name of SOURCES) {
    const path = join(HERE, name);
    found.push(...(await files(path).catch(() => [path])));
  }
  return found.sort();
}

/** One word for all sources, as tests/dashboard/test_build.py computes it too. */
async function fingerprint() {
  const hash = createHash("sha256");
  for (const path of await sources()) {
    const digest = createHash("sha256").update(await readFile(path)).digest("hex");
    hash.update(`${path.slice(HERE.length + 1)} ${digest}\n`);
  }
  return hash.digest("hex");
}

async function licences() {
  const texts = [];
  for (const name of SHIPPED) {
    const folder = join(HERE, "node_modules", name);
    const about = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
    const file = (await readdir(folder)).find((entry) => /^licen[cs]e/i.test(entry));
    const whole = file ? (await readFile(join(folder, file), "utf8")).trim() : `Its package holds no licence text: ${about.license}.`;
    texts.push(`${name} ${about.version} (${about.license})\n\n${whole}\n`);
  }
  return texts.join(`\n${"-".repeat(80)}\n\n`);
}

async function copyRest() {
  for (const name of ["index.html", "models"]) {
    await cp(join(HERE, name), join(OUT, name), { recursive: true });
  }
  await writeFile(join(OUT, "licences.txt"), await licences());
  await writeFile(join(OUT, "sources.sha256"), `${await fingerprint()}\n`);
}

async function check() {
  const [built, kept] = await Promise.all([OUT, KEPT].map(async (folder) => (await files(folder)).map((path) => path.slice(folder.length)).sort()));
  const names = [...new Set([...built, ...kept])];
  const same = await Promise.all(names.map(async (name) => {
    const [one, other] = await Promise.all([OUT, KEPT].map((folder) => readFile(join(folder, name)).catch(() => null)));
    return Boolean(one && other && one.equals(other));
  }));
  const different = names.filter((_, index) => !same[index]);
  if (!different.length) return console.log("The page that is kept is the one that is built.");
  console.error(`Build the page again (make page): ${different.join(", ")} differ.`);
  process.exitCode = 1;
}

/** What was built takes the place of what was kept, once all of it is there. */
async function keep() {
  await rm(KEPT, { recursive: true, force: true });
  await cp(OUT, KEPT, { recursive: true });
}

if (process.argv.includes("--watch")) {
  const context = await esbuild.context(options);
  await copyRest();
  await context.watch();
} else {
  await esbuild.build(options);
  await copyRest();
  await (process.argv.includes("--check") ? check() : keep());
  await rm(OUT, { recursive: true });
}
