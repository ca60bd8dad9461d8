// Makes pictures of the console again: node docs/images/console.mjs OSTEON NODE_MODULES [NAME …].
// Each of a run is of a demo in virtual time, which goes in short turns from `near` on and is halted (SIGSTOP) once it shows
// what the picture is of, so that it does not depend on the machine. The others are of recordings of such demos. OSTEON: build/release/app/osteon; NODE_MODULES: the console's, with puppeteer-core.
// OSTEON_PICTURES: another folder than this one.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const [, , osteon, modules, ...names] = process.argv;
const puppeteer = createRequire(join(resolve(modules), "x.js"))("puppeteer-core");
const pictures = process.env.OSTEON_PICTURES ?? dirname(fileURLToPath(import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "osteon_console_"));
const PATIENCE_MS = 600_000, SETTLES_MS = 5_000, TURN_MS = 200;
const pause = (time_ms) => new Promise((done) => setTimeout(done, time_ms));

const silent = (wire, from, to) => {
  const cell = join(folder, `${wire}.yaml`);
  writeFileSync(cell, `extends: demo\ninjections: [{wire: ${wire}, direction: both, from_s: ${from}, to_s: ${to}, silence: true}]\n`);
  return cell;
};

/** Of each picture: the demo's words, what the page shows then, and which panel is the uppermost. */
const wanted = [
  {
    name: "console_procedure",
    top: "procedure",
    words: ["--plan", "acetabulum", "--seconds", "400"],
    near: "osteon.procedure.note?.tool === 1",
    ready: "osteon.procedure.note?.tool === 1 && osteon.procedure.note.to_go_mm < 1 && osteon.live.status.state_number === 5",
  },
  {
    name: "console_fault",
    words: ["--seconds", "60", "--cell", silent("force_sensor", 17, 100)],
    near: "osteon.live.status.rendered_s > 10",
    ready: 'document.querySelector("#faults .fault") !== null',
  },
  {
    name: "console_held",
    words: ["--seconds", "60", "--at-fault", "hold", "--cell", silent("arm", 17, 17.06)],
    near: "osteon.live.status.rendered_s > 10",
    ready: '!document.getElementById("recover").disabled',
  },
];

/** Of each picture of recordings: the demos' words, the time shown, what the page shows before and after the keys. */
const side = (number, expression) => `document.getElementById("side-${number}").contentWindow.osteon?.${expression}`;
const both = (expression) => `${side(1, expression)} && ${side(2, expression)}`;
const sizes = [["--tool", "reamer:50"], ["--tool", "reamer:52"]];
const recorded = [
  {
    name: "console_distance",
    demos: [["--plan", "acetabulum"]],
    recording: "session/run_1.mcap",
    at_s: 79.9,
    ready: "osteon.procedure.note?.tool === 3 && osteon.scene.surface.triangles > 10000",
    keys: "d",
    after: 'document.getElementById("view-scale").innerText.length > 0',
  },
  { name: "console_compare", demos: sizes, recording: "recording.mcap", at_s: 6, ready: both("scene.surface.triangles > 10000"), keys: "", after: "true" },
  {
    name: "console_bone_difference",
    demos: sizes,
    recording: "recording.mcap",
    at_s: 6,
    ready: both("scene.surface.triangles > 10000"),
    keys: "b",
    after: both("scene.surface.layout?.difference_step_mm > 0"),
  },
];

const browser = await puppeteer.launch({
  protocolTimeout: PATIENCE_MS,
  executablePath: process.env.OSTEON_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  for (const { name, words, near, ready, top } of wanted.filter((one) => names.length === 0 || names.includes(one.name))) {
    const demo = spawn(resolve(osteon), ["demo", "--virtual-time", "--console", "0", "--overwrite", ...words],
      { cwd: mkdtempSync(join(folder, name)), stdio: ["ignore", "ignore", "pipe"] });
    const url = await new Promise((resolve, reject) => {
      let text = "";
      demo.stderr.on("data", (bytes) => {
        const found = /console: (http\S+)/.exec((text += bytes));
        if (found) resolve(found[1]);
      });
      demo.on("exit", () => reject(new Error(text)));
    });
    const page = await browser.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    await page.setViewport({ width: 1280, height: 720 });
    await page.goto(url);
    const shows = (expression) =>
      page.evaluate(`Boolean(osteon.live?.status?.known && osteon.scene.surface.triangles > 10000 && (${expression}))`);
    const drawn = () => page.evaluate("osteon.scene.drawn");
    while (!(await shows(near)) && !(await shows(ready))) await pause(50);
    for (demo.kill("SIGSTOP"); !(await shows(ready)); demo.kill("SIGSTOP")) {
      demo.kill("SIGCONT");
      await pause(TURN_MS);
      demo.kill("SIGSTOP");
      await pause(2 * TURN_MS);
    }
    await pause(SETTLES_MS); // the last messages arrive, and are drawn
    for (const key of ["z", "z"]) {
      const before = await drawn();
      await page.keyboard.press(key);
      while ((await drawn()) === before) await pause(100);
    }
    // without what the page says of a slow machine, and of a demo that is halted
    await page.evaluate((top) => {
      document.getElementById("answer").textContent = document.getElementById("view-behind").textContent = "";
      if (top) document.getElementById(top).scrollIntoView();
    }, top);
    await page.screenshot({ path: join(pictures, `${name}.png`) });
    await page.close();
    demo.kill("SIGKILL");
  }
  for (const { name, demos, recording, at_s, ready, keys, after } of recorded.filter((one) => names.length === 0 || names.includes(one.name))) {
    const recordings = [];
    for (const words of demos) {
      const out = mkdtempSync(join(folder, name));
      const made = spawn(resolve(osteon), ["demo", "--virtual-time", "--console", "off", "--overwrite", "--out", out, ...words], { stdio: "ignore" });
      await new Promise((done) => made.on("exit", done));
      recordings.push(join(out, recording));
    }
    const view = spawn(resolve(osteon), ["view", ...recordings, "--at", String(at_s), "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
    const url = await new Promise((done) => view.stdout.once("data", (bytes) => done(String(bytes).trim())));
    const page = await browser.newPage();
    page.setDefaultTimeout(PATIENCE_MS);
    await page.setViewport({ width: 1280, height: 720 });
    await page.goto(url);
    await page.waitForFunction(ready, { polling: 200 });
    for (const key of keys) await page.keyboard.press(key);
    await page.waitForFunction(after, { polling: 200 });
    await pause(SETTLES_MS);
    await page.screenshot({ path: join(pictures, `${name}.png`) });
    await page.close();
    view.kill("SIGKILL");
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
