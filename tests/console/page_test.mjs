// Tests the console's page in a real Chromium: node page_test.mjs OSTEON NODE_MODULES PICTURES STEPS. STEPS is `live`, for
// cells that run, or `recorded`, for recordings. Each wait ends as soon as its condition holds. A picture of each state is
// saved in PICTURES for people to look at.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";

const [, , osteon, modules, pictures, steps] = process.argv;
const puppeteer = createRequire(join(modules, "x.js"))("puppeteer-core");
const PATIENCE_MS = 150_000; // a view of recordings gives way to whatever else runs
const folder = mkdtempSync(join(tmpdir(), "osteon_page_"));
mkdirSync(pictures, { recursive: true });

// Faults in a run's summary that a machine too slow for wall time causes.
const LATE = /Faults +(contact model stale|arm message stale|force sensor stale|motion not permitted|spindle drive fault|arm left COMMANDING_ACTIVE).*/;

let lastDemo; // the demo that was started last

/** Starts a demo. @returns its process, and promises of its console's address and of its exit code with all its output */
function demo(seconds, ...more) {
  const child = start(["demo", "--seconds", String(seconds), "--port", "0", "--console", "0", "--overwrite", "--out",
    join(folder, "out"), ...more], { stdio: ["ignore", "pipe", "pipe"] });
  let text = "";
  child.stdout.on("data", (bytes) => (text += bytes)); // the summary, for the message of a check that fails
  const url = new Promise((resolve, reject) => {
    child.stderr.on("data", (bytes) => {
      text += bytes;
      const found = /console: (http\S+)/.exec(text);
      if (found) resolve(found[1]);
    });
    child.on("exit", () => reject(new Error(`the demo ended before it had a console:\n${text}`)));
  });
  const ended = new Promise((resolve) => child.on("close", (code) => resolve({ code, text })));
  lastDemo = { child, ended };
  return { child, url, ended };
}

/**
 * The options of a demo that ends after 320 s at the earliest, unless a page ends it before. It runs in virtual time, so that
 * slow drawing does not disturb it, and five times as fast as real time at most, so that a fast machine is not far ahead of a page.
 */
const LONG = [1600, "--virtual-time", "--real-time-factor", "5"];

/**
 * A cell for wall time whose limits of time are wide: with the demo's own, a machine that wakes a thread 25 ms late ends a run.
 * @param more  further lines of its file @returns its file
 */
function patientCell(more = "") {
  const file = join(folder, "patient.yaml");
  writeFileSync(file, `extends: demo
watchdog: {model_stop_ms: 1000, sensor_stop_ms: 1000, arm_miss_count: 100}
drive: {lost_ms: 1000, heartbeat_ms: 100}
plc: {max_age_ms: 1000}
link_quality: {good_lost_count: 1000, end_lost_in_a_row_count: 1000, end_lost_count: 1000, ask_again: true}
${more}`);
  return file;
}

/**
 * Runs steps with a demo in wall time, five times at most. Chromium draws on the processor, which now and then makes the
 * machine too slow for the demo. If the demo's summary names a fault of this kind, the steps run again.
 * @param late  finds such a fault in the summary
 * @param exitCode  of the demo whose steps are all done
 */
async function retryWhereMachineWasLate(steps, late = LATE, exitCode = 0) {
  for (let attempt = 1; ; ++attempt) {
    try {
      const done = steps(); // its demo has started
      const failed = lastDemo.ended.then(({ code, text }) => {
        if (code !== exitCode) throw new Error(`the demo ended with ${code}:\n${text}`);
        return done;
      });
      return await Promise.race([done, failed]); // no wait goes on after the end of a demo that failed
    } catch (error) {
      for (const page of await browser.pages())
        console.log("shown when it failed:", await shown(page));
      lastDemo.child.kill("SIGINT");
      const { text } = await lastDemo.ended;
      const found = late.exec(text);
      if (!found || attempt === 5) throw error;
      console.log(`the machine was late (${found[0]}): once more`);
      for (const page of await browser.pages()) if (page.url() !== "about:blank") await page.close({ runBeforeUnload: false });
    }
  }
}

const browser = await puppeteer.launch({
  protocolTimeout: 2 * PATIENCE_MS,
  executablePath: process.env.OSTEON_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
const errors = [];

/** Starts a command of osteon. The test ends it at the latest: a process that is left would hold the test's output open. */
const started = [];
function start(args, options) {
  const child = spawn(osteon, args, options);
  started.push(child);
  return child;
}

/** Opens a page. Errors of its scripts, and requests to any other server, are added to `errors`. */
async function open(url, width, height) {
  const page = await browser.newPage();
  page.setDefaultTimeout(PATIENCE_MS);
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("requestfinished", (request) => {
    if (!request.url().startsWith(new URL(url).origin) && !request.url().startsWith("data:")) errors.push(`asked for ${request.url()}`);
  });
  await page.setViewport({ width, height });
  await page.goto(url);
  return page;
}
/** Waits until an expression is true in the page, and no longer than the demo runs. */
const untilOrEnd = (page, run, expression) =>
  Promise.race([until(page, expression), run.ended.then(({ code, text }) => {
    throw new Error(`the demo ended with ${code} before ${expression}:\n${text}`);
  })]);
/** What a page shows, for the message of a wait that fails. */
const shown = (page) =>
  page.evaluate(`JSON.stringify([osteon.connected, osteon.live?.status?.state, osteon.live?.status?.rendered_s, osteon.role,
    document.getElementById("answer")?.textContent])`).catch(() => page.url());
/** Waits until a JavaScript expression is true in the page. */
async function until(page, expression) {
  try {
    await page.waitForFunction(expression, { polling: 50 });
  } catch (error) {
    throw new Error(`${error.message}: ${expression}\nshown: ${await shown(page)}`, { cause: error });
  }
}
/**
 * Does something in the page, again every five seconds, until an expression is true. A page that was too slow has no connection
 * for a second, and what it asks for then is lost.
 */
async function doUntil(page, act, expression) {
  for (const end = Date.now() + PATIENCE_MS; ; ) {
    await act();
    try {
      return void (await page.waitForFunction(expression, { polling: 50, timeout: 5000 }));
    } catch (error) {
      if (Date.now() > end) throw new Error(`${error.message}: ${expression}\nshown: ${await shown(page)}`, { cause: error });
    }
  }
}
/** Presses a button, once it can be pressed, until an expression is true: a page has no operator's role yet when it shows figures. */
const press = (page, id) => page.evaluate(`document.querySelector("#${id}:enabled")?.click()`);
const pressUntil = (page, id, expression) => doUntil(page, () => press(page, id), expression);
const inState = (name) => `document.querySelector("#state .name")?.textContent === "${name}"`;
const answers = (words) => `document.getElementById("answer").textContent.includes("${words}")`;
/** Waits until the page shows this state of the cell. */
const stateIs = (page, name) => until(page, inState(name));
const picture = (page, name) => page.screenshot({ path: join(pictures, `${name}.png`) });
const status = (page) => page.evaluate("osteon.live?.status");

/** What does not fit in the page: texts wider than their element, texts of the 3D view that overlap, sideways scrolling. */
const clipped = (page) =>
  page.evaluate(() => {
    const wide = [...document.querySelectorAll("button, select, h2, td, li, .name, .big")]
      .filter((e) => e.offsetParent && e.scrollWidth > e.clientWidth + 1)
      .map((e) => e.textContent);
    const shown = ["view-behind", "view-scale", "view-plan", "view-hint"].map((id) => document.getElementById(id))
      .filter((e) => e?.offsetParent && e.textContent).map((e) => [e.id, e.getBoundingClientRect()]);
    for (const [i, [name, a]] of shown.entries())
      for (const [other, b] of shown.slice(i + 1))
        if (a.left < b.right && b.left < a.right && a.top < b.bottom - 1 && b.top < a.bottom - 1) wide.push(`${name} over ${other}`);
    if (document.documentElement.scrollWidth > innerWidth) wide.push("the page scrolls sideways");
    return wide;
  });

/** A drag over one chart zooms all four to the dragged part and freezes them; a double click shows the last 30 s again. */
async function zoomsTheCharts(page) {
  const spans = () => page.evaluate("osteon.charts.plots.map(({ plot }) => [plot.scales.x.min, plot.scales.x.max])");
  const whole = Array.from({ length: 4 }, () => [-30, 0]);
  assert.deepEqual(await spans(), whole);
  const [left, middle, width] = await page.evaluate(`(() => {
    const over = osteon.charts.plots[0].plot.over.getBoundingClientRect();
    return [over.left, over.top + over.height / 2, over.width];
  })()`);
  await page.mouse.move(left + 0.7 * width, middle);
  await page.mouse.down();
  await page.mouse.move(left + 0.9 * width, middle, { steps: 4 });
  await page.mouse.up();
  const near = ([from, to]) => Math.abs(from + 9) < 1 && Math.abs(to + 3) < 1;
  await until(page, "osteon.charts.frozen && osteon.charts.plots[0].plot.scales.x.min > -15");
  const tick = await page.evaluate("osteon.live.windows[0][0]");
  await until(page, `osteon.live.windows[0][0] > ${tick} + 0.5`); // new data arrive, and the zoom stays
  assert.ok((await spans()).every(near), JSON.stringify(await spans()));
  await picture(page, "zoomed");
  await page.mouse.click(left + 0.5 * width, middle, { count: 2 });
  await until(page, "osteon.charts.plots[0].plot.scales.x.min === -30");
  assert.deepEqual(await spans(), whole);
  await page.click(".freeze");
  assert.equal(await page.evaluate("osteon.charts.frozen"), false);
}

/** Moves the view by `act`, and waits until the camera has moved. */
async function movesTheView(page, act) {
  const before = await page.evaluate("osteon.scene.pose()");
  await act();
  await until(page, `osteon.scene.pose() !== "${before}"`);
}

const MOVES = "[4, 5].includes(osteon.live.status.state_number)"; // haptic or cutting

/** Presses a button, again every second, until a promise is fulfilled. @returns what the promise gives */
async function pressUntilDone(page, id, promise) {
  for (let done = false; !done; done = await Promise.race([promise.then(() => true), new Promise((later) => setTimeout(later, 1000))]))
    await press(page, id);
  return promise;
}
/** Presses Stop until the demo has ended, and says yes: Stop asks while the cell cuts. @returns exit code and output of the demo */
function stops(page, run) {
  page.off("dialog").on("dialog", (dialog) => void dialog.accept());
  return pressUntilDone(page, "stop", run.ended);
}

/** A cell in wall time: its times are measured and shown. The page pauses it, lets it go on, and ends the run. */
const operatesACellInWallTime = () => retryWhereMachineWasLate(async () => {
  const run = demo(60, "--cell", patientCell()); // ended by the page
  const page = await open(await run.url, 390, 844); // a small picture, which is drawn sooner
  await stateIs(page, "cutting");
  await until(page, "osteon.live.status.compute_p99_us > 0 && osteon.scene.drawn > 0");
  const now = await status(page);
  for (const age of ["arm_age_ms", "plc_age_ms", "compute_p99_us"]) assert.ok(Number.isFinite(now[age]), `${age}: ${now[age]}`);
  const health = await page.evaluate('document.getElementById("health").innerText');
  assert.match(health, /Tick, 99 % below\s+[\d.]+ µs/);
  await pressUntil(page, "pause", inState("paused"));
  await doUntil(page, () => page.keyboard.press("r"), MOVES);
  await picture(page, "wall_time");
  const { code, text } = await stops(page, run);
  assert.equal(code, 0, text);
  await page.close();
});

/** A cutting cell with two pages: figures, pause, gains, languages, views, and the operator's role. The page ends the run. */
async function operatesTheCell() {
  const run = demo(...LONG);
  const url = await run.url;
  const page = await open(url, 1280, 720);
  await stateIs(page, "cutting");
  assert.deepEqual(await clipped(page), []);

  await until(page, "osteon.live.status.removed_mm3 > 1000"); // the hand reaches the bone after a while
  await until(page, "osteon.scene.surface.triangles > 10000 && osteon.scene.drawn > 5"); // the bone, as it is carved
  const whole = await page.evaluate("osteon.scene.surface.whole");
  await until(page, `osteon.scene.surface.whole > ${whole} + 5`); // complete changes arrive while the cut goes on
  assert.ok(await page.evaluate("osteon.live.status.bone_age_ms >= 0"));
  const behind = '(osteon.showBoneAge(2300), document.getElementById("view-behind").textContent)'; // as on a machine that is too busy to follow
  assert.equal(await page.evaluate(behind), "▲ bone 2.3 s behind");
  await picture(page, "cutting");
  await zoomsTheCharts(page);
  const now = await status(page);
  for (const age of ["arm_age_ms", "plc_age_ms", "disk_left_B", "depth_left_mm", "feed_mm_per_s"])
    assert.ok(Number.isFinite(now[age]), `${age}: ${now[age]}`);
  const [force, figures, health] = await page.evaluate('["force", "figures", "health"].map((id) => document.getElementById(id).innerText)');
  for (const part of ["limit", "N (", "Torque"]) assert.ok(force.includes(part), force);
  for (const part of ["To the depth limit", "Feed along the axis", "rpm"]) assert.ok(figures.includes(part), figures);
  for (const part of ["arm's message", "PLC's word", "Messages lost", "Disk left"]) assert.ok(health.includes(part), health);

  // a new figure replaces only the text of its table cell, so that a selection in the cell stays
  const removed = '[...document.querySelectorAll("#figures tr")].find((row) => row.textContent.includes("Bone removed")).lastChild';
  await page.evaluate(`window.figureCell = ${removed}; window.figureText = figureCell.textContent`);
  await until(page, "figureCell.textContent !== figureText");
  assert.ok(await page.evaluate("figureCell.isConnected"));

  // a second page only watches: the server refuses its requests
  const second = await open(url, 390, 844);
  await stateIs(second, "cutting");
  assert.deepEqual(await clipped(second), []);
  assert.ok(await second.evaluate('document.getElementById("pause").disabled'));
  const asksToStop = () => second.evaluate('osteon.connection.ask("stop")'); // sent although the page has no enabled button for it
  await doUntil(second, asksToStop, answers("watches"));
  await picture(second, "phone");
  await second.select("#language", "de"); // a refusal is translated too
  await doUntil(second, asksToStop, answers("sieht zu"));
  assert.deepEqual(await clipped(second), []);
  await second.select("#language", "en");

  await page.bringToFront(); // Chromium draws nothing behind another page
  await pressUntil(page, "pause", inState("paused"));
  await picture(page, "paused");
  const paused = await status(page);
  assert.equal(paused.force_N, 0);
  assert.ok(paused.permits.length === 10);
  for (const key of ["r", "p", "r"]) await doUntil(page, () => page.keyboard.press(key), key === "p" ? inState("paused") : MOVES);

  // gains: an accepted value acts, a refused one is explained, and a change can be undone
  const gains = (field) => page.evaluate(`osteon.gains.note.${field}`);
  const setGain = async (id, value) => {
    await page.evaluate(`document.getElementById("gain-${id}").value = "${value}"`);
    await page.evaluate(`document.getElementById("set-${id}").click()`);
  };
  // the panel names the command that measures gains, without a look into a document
  assert.match(await page.evaluate('document.getElementById("gains-tune").textContent'), /osteon tune demo/);
  const [ownDrag, ownStiffness] = [await gains("own_drag_Ns_per_m"), await gains("own_stiffness_N_per_m")];
  await doUntil(page, () => setGain("drag", 2 * ownDrag), `osteon.gains.note.drag_Ns_per_m === ${2 * ownDrag} && osteon.gains.note.can_undo`);
  // refused: more than the cell's own stiffness
  await doUntil(page, () => setGain("stiffness", (2 * ownStiffness) / 1000), answers("stiffness: found"));
  assert.equal(await gains("stiffness_N_per_m"), ownStiffness);
  assert.deepEqual(await clipped(page), []);
  await page.evaluate('document.getElementById("gains").scrollIntoView()');
  await picture(page, "gains");
  await pressUntil(page, "undo-gains", `osteon.gains.note.drag_Ns_per_m === ${ownDrag} && !osteon.gains.note.can_undo`);
  await doUntil(second, () => second.evaluate('osteon.connection.ask("drag", 40)'), answers("watches")); // a page that watches

  // all texts fit in German and in large type
  await page.select("#language", "de");
  await until(page, 'document.getElementById("pause").textContent.startsWith("Anhalten")');
  assert.deepEqual(await clipped(page), []);
  await page.click("#large");
  assert.deepEqual(await clipped(page), []);
  await picture(page, "german_large");
  await page.click("#large");

  // each key for a view draws a new picture
  for (const key of ["2", "3", "4", "5", "c", "z", "1"]) {
    const drawn = await page.evaluate("osteon.scene.drawn");
    await page.keyboard.press(key);
    await until(page, `osteon.scene.drawn > ${drawn}`);
    if (key === "5" || key === "c") await picture(page, key === "5" ? "cell" : "cut_open");
  }

  // the view turns, moves and zooms by keys
  for (const key of ["ArrowLeft", "ArrowUp", "+", "-"]) await movesTheView(page, () => page.keyboard.press(key));
  await movesTheView(page, async () => {
    await page.keyboard.down("Shift");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.up("Shift");
  });

  // a page that reloads often is served each time; after it has closed, the second page can take the role
  for (let i = 0; i < 5; ++i) await page.reload();
  await until(page, "osteon.live?.status.known");
  await page.close();
  await until(second, '!document.getElementById("take-role").disabled');

  await until(second, "osteon.role.mine || (osteon.connection.ask('role'), false)");
  await second.bringToFront();
  const { code, text } = await stops(second, run);
  assert.equal(code, 0, text);
  await until(second, 'document.getElementById("connection").textContent.length > 0 && !osteon.connected');
  await second.close();
}

/** The panel and the picture of a plan, and refused requests, which say why. */
async function operatesAProcedure() {
  const run = demo(...LONG, "--plan", "acetabulum");
  const page = await open(await run.url, 1280, 720);
  await until(page, "osteon.procedure.note?.known && osteon.scene.planView !== null");
  assert.equal(await page.evaluate("osteon.procedure.plan.reamers.length"), 4);
  assert.deepEqual(await clipped(page), []);
  await pressUntil(page, "next-tool", answers("not paused"));
  // Finish asks for confirmation, and its question names what is left of the plan; the test declines
  const asked = new Promise((resolve) => page.on("dialog", (dialog) => void dialog.dismiss().then(() => resolve(dialog.message()))));
  assert.match(await pressUntilDone(page, "finish", asked), /no pass of its last tool, 50 mm, counts/);
  // the score, which a pass may have made known by now
  await until(page, 'document.getElementById("score").innerText.includes(osteon.procedure.score?.known ? "points" : "known once a pass has ended")');
  await press(page, "undo-pass");
  await until(page, "osteon.procedure.note.to_go_mm < 15 && osteon.scene.surface.triangles > 10000");
  await picture(page, "procedure");
  // no request has changed the tool: the demo's operator changes it after a pass
  assert.ok(await page.evaluate("((note) => note.tool <= note.passes + note.undone)(osteon.procedure.note)"));
  await pressUntil(page, "next-tool", answers("not paused"));
  await page.select("#language", "de"); // the earlier answer is translated too
  await until(page, answers("nicht angehalten"));
  assert.deepEqual(await clipped(page), []);
  for (const width of [400, 390]) {
    await page.setViewport({ width, height: 844 });
    await page.evaluate("osteon.showBoneAge(2300)");
    assert.deepEqual(await clipped(page), []);
  }
  const drawn = await page.evaluate("osteon.scene.drawn");
  await until(page, `osteon.scene.drawn > ${drawn} + 1`);
  await picture(page, "procedure_german_phone");
  const { code, text } = await stops(page, run);
  assert.equal(code, 0, text);
  await page.close();
}

/** Views a session's recording: the plan, the tool in use at each time, and the procedure's figures. */
async function viewsAProcedure() {
  const made = start(["demo", "--plan", "acetabulum", "--virtual-time", "--seconds", "20", "--out", join(folder, "planned")], { stdio: "ignore" });
  assert.equal(await new Promise((resolve) => made.on("close", resolve)), 0);
  const child = start(["view", join(folder, "planned", "session", "run_1.mcap"), "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve) => child.stdout.once("data", (bytes) => resolve(String(bytes).trim())));
  const page = await open(url, 1280, 720);
  await until(page, "osteon.scene.planView !== null && osteon.procedure.note?.tool === 0 && osteon.scene.toolIndex === 0");
  await page.evaluate('osteon.connection.ask("seek", osteon.timeline.state.duration_s)');
  await until(page, "osteon.procedure.note.tool === 3 && osteon.scene.toolIndex === 3 && osteon.procedure.note.passes > 0");
  assert.ok(await page.evaluate("osteon.hello.tools[3][0][3] > osteon.hello.tools[0][0][3]"), "a larger reamer");
  assert.ok(!/reamer/.test(await page.evaluate('document.getElementById("title").textContent')), "one of several tools");
  assert.equal(await page.evaluate('getComputedStyle(document.getElementById("next-tool").parentElement).display'), "none");
  await until(page, "osteon.scene.surface.triangles > 10000");
  assert.deepEqual(await clipped(page), []);
  await picture(page, "view_procedure");
  // key D colours the bone by its distance to the planned cup: green where the reamers have cut, blue where bone is left
  const vertexColours = `(() => {
    const count = { green: 0, blue: 0, all: 0 };
    for (const { mesh } of osteon.scene.surface.blocks.values()) {
      const colour = mesh?.geometry.getAttribute("color").array ?? [];
      for (let i = 0; i < colour.length; i += 3) {
        ++count.all;
        if (colour[i + 1] > 2 * colour[i]) ++count[colour[i + 1] > colour[i + 2] ? "green" : "blue"];
      }
    }
    return count;
  })()`;
  assert.equal((await page.evaluate(vertexColours)).green, 0, "tissue");
  await page.keyboard.press("d");
  await until(page, `${vertexColours}.green > 0`);
  assert.ok((await page.evaluate('document.getElementById("view-scale").innerText')).includes("still to cut"));
  assert.deepEqual(await clipped(page), []);
  await picture(page, "view_procedure_distance");
  await page.keyboard.press("d");
  await until(page, `${vertexColours}.green === 0`);
  await page.select("#language", "de");
  await page.setViewport({ width: 400, height: 844 });
  assert.deepEqual(await clipped(page), []);
  await picture(page, "view_procedure_german_phone");
  await page.close();
  child.kill("SIGINT");
}

/** The arm's simulation is killed: the page shows the fault's card, also after the run has ended. */
async function showsAFault() {
  const { run, page } = await retryWhereMachineWasLate(async () => {
    const run = demo(60, "--cell", patientCell());
    const page = await open(await run.url, 1280, 720);
    await stateIs(page, "cutting");
    // the simulated arm is a process of its own, until a late machine ends the demo
    const cells = execFileSync("pgrep", ["-P", String(run.child.pid)]).toString().trim().split("\n");
    for (const pid of cells) process.kill(Number(pid), "SIGKILL");
    return { run, page };
  });
  await until(page, 'document.querySelector("#faults .fault") !== null');
  const card = await page.evaluate('document.getElementById("faults").innerText');
  for (const part of ["Fault:", "Seen:", "The cell:", "Go on:"]) assert.ok(card.includes(part), card);
  assert.deepEqual(await clipped(page), []);
  await picture(page, "fault");
  const { code } = await run.ended;
  assert.equal(code, 1);
  assert.ok(await page.evaluate('document.querySelector("#faults .fault") !== null'), "the card stays after the run");
  await page.close();
}

/** The fault's card has the measured value and the stop's report. Acknowledging folds the card, and clears nothing. */
async function acknowledgesAFault(page) {
  const card = () => page.evaluate('document.getElementById("faults").innerText');
  const [fault] = (await status(page)).faults;
  assert.ok(fault.seen && (await card()).includes(fault.seen), `what was measured: ${await card()}`);
  assert.ok(/_stop_1\.html$/.test(fault.page) && (await card()).includes(fault.page), await card());
  await page.keyboard.press("k");
  await until(page, 'document.querySelector("#faults .known") !== null');
  assert.ok(!(await card()).includes("Go on:"), await card());
  assert.equal((await status(page)).faults.length, 1, "it stays latched");
  assert.ok(!(await page.evaluate('document.getElementById("recover").disabled')));
  await page.evaluate('document.querySelector("#faults button").click()');
  await until(page, 'document.querySelector("#faults .known") === null');
  assert.ok((await card()).includes("Go on:"), await card());
}

// Faults that a machine too slow for wall time adds to an arm that is silent. Nothing recovers from them, and the demo ends.
const LATE_BESIDE_THE_ARM = /Faults +.*(contact model stale|force sensor stale|motion not permitted|spindle drive fault).*/;

/** A recoverable fault of an arm that is silent for a second, in all widths and languages; Recover lets the cell move again. */
const recoversFromAFault = () => retryWhereMachineWasLate(async () => {
  const silence = "injections: [{wire: arm, direction: both, from_s: 10, to_s: 11, silence: true}]\n"; // longer than the cell waits
  const run = demo(180, "--cell", patientCell(silence), "--at-fault", "hold"); // ended by the page
  const page = await open(await run.url, 1280, 720);
  await until(page, "osteon.live?.status.known");
  // nothing to recover from, unless this page was so slow that it comes after the fault
  assert.ok(await page.evaluate('document.getElementById("recover").disabled || osteon.live.status.state === "fault"'));
  await untilOrEnd(page, run, `${inState("fault")} && !document.getElementById("recover").disabled`);
  assert.ok((await page.evaluate('document.getElementById("faults").innerText')).includes("Recover clears it"));
  assert.deepEqual(await clipped(page), []);
  await picture(page, "held");
  await acknowledgesAFault(page);
  await page.select("#language", "de");
  await until(page, 'document.getElementById("recover").textContent.startsWith("Neu anlaufen")');
  await until(page, 'document.getElementById("faults").innerText.includes("Arm hat COMMANDING_ACTIVE verlassen") || document.getElementById("faults").innerText.includes("Nachricht des Arms veraltet")');
  assert.deepEqual(await clipped(page), []);
  await until(page, 'document.getElementById("events").innerText.includes("Fehler: ")');
  await picture(page, "held_german");
  await page.setViewport({ width: 390, height: 844 });
  assert.deepEqual(await clipped(page), []);
  await picture(page, "held_phone");
  await page.setViewport({ width: 1280, height: 720 });
  await page.select("#language", "en");
  await doUntil(page, () => page.keyboard.press("v"), MOVES);
  assert.equal(await page.evaluate('document.querySelector("#faults .fault")'), null);
  assert.ok(await page.evaluate('document.getElementById("recover").disabled'));
  await picture(page, "recovered");
  const { code, text } = await stops(page, run);
  assert.equal(code, 1, `a recovered fault is still a fault\n${text}`);
  await page.close();
}, LATE_BESIDE_THE_ARM, 1);

/** Makes the recording that the next steps view. */
async function recordsADemo() {
  const made = start(["demo", "--virtual-time", "--seconds", "6", "--out", join(folder, "out")], { stdio: "ignore" });
  assert.equal(await new Promise((resolve) => made.on("close", resolve)), 0);
}

/** At a time of a paused recording, the strip charts show everything from the beginning to this time. */
async function showsThePastOf(page, at_s) {
  const times = "osteon.charts.shown.time_s.map((time) => time - osteon.timeline.state.start_s)";
  await until(page, `((times) => times[0] < 0.1 && Math.abs(times.at(-1) - ${at_s}) < 0.05)(${times})`);
  assert.ok(await page.evaluate("osteon.charts.plots.every(({ plot }) => plot.data[0].length === osteon.charts.shown.time_s.length)"));
}

/** Views a recording: seek, play, pause, jump to an event. */
async function viewsARecording() {
  const child = start(["view", join(folder, "out", "recording.mcap"), "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve) => child.stdout.once("data", (bytes) => resolve(String(bytes).trim())));
  const page = await open(url, 1280, 720);
  await until(page, "osteon.live && !document.getElementById('timeline').hidden");
  const duration = await page.evaluate("osteon.timeline.state.duration_s");
  await page.evaluate(`osteon.connection.ask("seek", ${0.6 * duration})`);
  await until(page, `Math.abs(osteon.timeline.state.at_s - ${0.6 * duration}) < 0.05`);
  await until(page, "osteon.timeline.news?.done && osteon.scene.surface.triangles > 10000");
  await showsThePastOf(page, 0.6 * duration);
  assert.deepEqual(await clipped(page), []);
  await picture(page, "view");
  await page.click("#play");
  await until(page, `osteon.timeline.state.at_s > ${0.6 * duration + 0.3}`);
  await page.keyboard.press(" ");
  await until(page, "!osteon.timeline.state.playing");
  await page.keyboard.press(","); // jumps to the event before
  await until(page, `osteon.timeline.state.at_s < ${0.6 * duration}`);
  await showsThePastOf(page, await page.evaluate("osteon.timeline.state.at_s"));
  // after a new hello, the hidden arm stays hidden
  await page.click("#arm");
  await page.evaluate("osteon.take(osteon.hello)");
  assert.equal(await page.evaluate('osteon.scene.arm.group.visible || document.getElementById("arm").getAttribute("aria-pressed") === "true"'), false);
  await page.close();
  child.kill("SIGINT");
}

/** Compares a recording with itself: side by side there is no difference, and views and playback go together. */
async function comparesTwoRecordings() {
  const recording = join(folder, "out", "recording.mcap");
  const child = start(["view", recording, recording, "--at", "2", "--port", "0"], { stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve) => child.stdout.once("data", (bytes) => resolve(String(bytes).trim())));
  const page = await open(url, 1280, 720);
  await until(page, "document.getElementById('most').textContent.includes('No difference')");
  await until(page, "Math.abs(osteon.timeline.state.at_s - 2) < 0.05");
  const side = (number, expression) => `document.getElementById("side-${number}").contentWindow.osteon?.${expression}`;
  for (const number of [1, 2]) await until(page, `${side(number, "scene.surface.triangles")} > 10000`);
  // turning one view turns the other view too
  await page.evaluate(side(1, "scene.preset('above')"));
  await until(page, `${side(1, "scene.pose()")} === ${side(2, "scene.pose()")} && ${side(2, "hello !== null")}`);
  assert.deepEqual(await clipped(page), []);
  await picture(page, "compare");
  // both play, and both stop at the same time of the recording
  await page.click("#play");
  await until(page, "osteon.timeline.state.at_s > 2.3");
  await page.click("#play");
  await until(page, "!osteon.timeline.state.playing");
  await until(page, `${side(1, "live.status.rendered_s")} === ${side(2, "live.status.rendered_s")}`);
  // key B maps the difference of the two bones: equal bones have none
  await page.keyboard.press("b");
  await until(page, 'document.getElementById("bones").textContent.includes("do not differ")');
  for (const number of [1, 2]) await until(page, `${side(number, "scene.surface.layout?.difference_step_mm")} > 0 && ${side(number, "scene.surface.triangles")} > 10000`);
  assert.deepEqual(await clipped(page), []);
  await page.setViewport({ width: 390, height: 844 });
  assert.deepEqual(await clipped(page), []);
  await page.setViewport({ width: 1280, height: 720 });
  await page.keyboard.press("b");
  for (const number of [1, 2]) await until(page, `${side(number, "scene.surface.layout?.difference_step_mm")} === undefined && ${side(number, "scene.surface.triangles")} > 10000`);
  await page.close();
  child.kill("SIGINT");
}

/** The page of a simulated cell without a controller shows the cell's state and has no buttons. */
async function showsACellAlone() {
  const child = start(["cell", "demo", "--port", "0", "--console", "0"], { stdio: ["ignore", "pipe", "inherit"] });
  let text = "";
  const url = await new Promise((resolve) => child.stdout.on("data", (bytes) => {
    text += bytes;
    const found = /console: (http\S+)/.exec(text);
    if (found) resolve(found[1]);
  }));
  const page = await open(url, 1280, 720);
  await stateIs(page, "MONITORING_WAIT");
  await until(page, 'document.getElementById("figures").textContent.includes("without power")');
  assert.ok(await page.evaluate('!document.getElementById("buttons").offsetParent'));
  assert.deepEqual(await clipped(page), []);
  await picture(page, "cell_alone");
  await page.setViewport({ width: 390, height: 844 });
  assert.deepEqual(await clipped(page), []);
  await picture(page, "cell_alone_phone");
  await page.close();
  child.kill("SIGINT");
}

const STEPS = {
  live: [showsACellAlone, operatesACellInWallTime, operatesTheCell, operatesAProcedure, showsAFault, recoversFromAFault],
  recorded: [recordsADemo, viewsARecording, comparesTwoRecordings, viewsAProcedure],
};

try {
  assert.ok(steps in STEPS, `STEPS: found ${steps}, accepted ${Object.keys(STEPS).join(", ")}`);
  for (const step of STEPS[steps]) {
    const began = Date.now();
    await step();
    console.log(`${step.name}: ${Math.round((Date.now() - began) / 1000)} s`);
  }
  assert.deepEqual(errors, []);
  console.log("the console's page: all steps done");
} finally {
  for (const child of started) if (child.exitCode === null) child.kill("SIGKILL");
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
}
