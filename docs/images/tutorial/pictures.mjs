// Makes the tutorial's pictures again: node docs/images/tutorial/pictures.mjs OSTEON NODE_MODULES.
// Runs the tutorial's commands in a folder of its own, opens their pages in Chromium and keeps the named parts of each.
// OSTEON: build/release/app/osteon; NODE_MODULES: the console's, with puppeteer-core.

import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [, , osteon, modules] = process.argv;
const puppeteer = createRequire(join(modules, "x.js"))("puppeteer-core");
const pictures = dirname(fileURLToPath(import.meta.url));
const root = join(pictures, "..", "..", "..");
const folder = mkdtempSync(join(tmpdir(), "osteon_tutorial_"));
const run = (...words) => {
  try {
    execFileSync(osteon, words, { cwd: folder, stdio: "ignore", env: { ...process.env, OSTEON_ROOT: root } });
  } catch (error) {
    if (error.status !== 1) throw error; // a fault that was planted
  }
};

writeFileSync(join(folder, "my_cell.yaml"), "extends: demo\nlimits: {max_force_N: 80}\n");
writeFileSync(
  join(folder, "silent.yaml"),
  "extends: demo\ninjections: [{wire: force_sensor, direction: both, from_s: 5, to_s: 100, silence: true}]\n",
);
run("demo", "--virtual-time");
run("demo", "--virtual-time", "--cell", "my_cell.yaml", "--tool", "reamer:54", "--out", "my_out");
run("demo", "--virtual-time", "--cell", "silent.yaml", "--out", "silent_out");
run("tune", join(root, "config", "cells", "demo.yaml"));

/** Of each page: whether its head stays, how many rows of its summary, and how many figures of each section. */
const wanted = [
  { name: "1_demo", page: "demo_out/report.html", head: true, rows: 99, sections: { "The bone": 1 } },
  { name: "2_report", page: "demo_out/report.html", head: false, rows: 0, sections: { Section: 1, Force: 1 } },
  { name: "3_own_cell", page: "my_out/report.html", head: true, rows: 0, sections: { Section: 1, Force: 1 } },
  { name: "4_stop", page: "silent_out/recording_stop_1.html", head: true, rows: 0, sections: { "What led to the stop": 1, "Forces and motion": 1 } },
  { name: "5_tune", page: "tune/tune.html", head: true, rows: 99, sections: { "How stiff a wall may be": 2 } },
];

const browser = await puppeteer.launch({
  executablePath: process.env.OSTEON_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  for (const { name, page: file, head, rows, sections } of wanted) {
    const page = await browser.newPage();
    await page.setViewport({ width: 1000, height: 720 });
    await page.goto(`file://${join(folder, file)}`);
    await new Promise((done) => setTimeout(done, 2000)); // the bone is drawn
    const missing = await page.evaluate(
      (head, rows, sections) => {
        let section = null, figures = 0;
        const seen = [];
        for (const element of [...document.querySelector("main").children]) {
          if (element.tagName === "H2") {
            section = element.textContent;
            figures = sections[section] ?? 0;
            seen.push(section);
          }
          const isFigure = element.tagName === "FIGURE";
          const keep = section === null ? head : section in sections && (!isFigure ? figures > 0 : figures-- > 0);
          if (!keep) element.remove();
        }
        if (rows === 0) for (const list of document.querySelectorAll("main > header ul.summary")) list.remove();
        return Object.keys(sections).filter((name) => !seen.includes(name));
      },
      head,
      rows,
      sections,
    );
    if (missing.length > 0) throw new Error(`${file}: found no section ${missing.join(", ")}`);
    await (await page.$("main")).screenshot({ path: join(pictures, `${name}.png`) });
    await page.close();
  }
} finally {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
