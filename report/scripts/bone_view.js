// Turns the carved bone of a page, by WebGL 2. Without it the view stays hidden, and the page has its pictures.
// The surface's bytes are described in simulation/surface/chunk_bytes.h.
"use strict";
(function () {
  const HEAD_BYTES = 8, VERTEX_BYTES = 6, BRICK_EDGE = 8, STEPS_PER_VOXEL = 28, MAX_BYTE_INDICES = 256;
  const MATERIAL = 0x7f, CUT = 0x80, CUT_TINT = [242, 201, 168], CUT_SHARE = 0.35;
  const FIELD_OF_VIEW = 0.5; // tangent of its half
  const UNDER = [0, 114, 178], NONE = [246, 243, 236], OVER = [213, 94, 0], NOT_CUT = [205, 205, 200];

  const bytesOf = (address) => Uint8Array.from(atob(address.slice(address.indexOf(",") + 1)), (c) => c.charCodeAt(0));
  const numbersOf = (text) => text.split(" ").map(Number);
  const mix = (a, b, share) => a.map((value, i) => value + share * (b[i] - value));

  function readChunks(bytes, layout) {
    const [ox, oy, oz, voxel, nx, ny] = layout, origin = [ox, oy, oz];
    const view = new DataView(bytes.buffer);
    const positions = [], normals = [], materials = [], indices = [];
    for (let at = 0; at < bytes.length; ) {
      const brick = view.getUint32(at, true), vertices = view.getUint16(at + 4, true), quads = view.getUint16(at + 6, true);
      const place = [brick % nx, Math.floor(brick / nx) % ny, Math.floor(brick / nx / ny)];
      const first = materials.length;
      at += HEAD_BYTES;
      for (let v = 0; v < vertices; ++v, at += VERTEX_BYTES) {
        for (let i = 0; i < 3; ++i)
          positions.push(origin[i] + (place[i] * BRICK_EDGE - 1 + bytes[at + i] / STEPS_PER_VOXEL) * voxel);
        let x = bytes[at + 3] / 127.5 - 1, y = bytes[at + 4] / 127.5 - 1;
        const z = 1 - Math.abs(x) - Math.abs(y);
        if (z < 0)
          [x, y] = [(1 - Math.abs(y)) * Math.sign(x || 1), (1 - Math.abs(x)) * Math.sign(y || 1)];
        const length = Math.hypot(x, y, z);
        normals.push(x / length, y / length, z / length);
        materials.push(bytes[at + 5]);
      }
      const wide = vertices > MAX_BYTE_INDICES, size = wide ? 8 : 4;
      for (let q = 0; q < quads; ++q, at += size) {
        const corner = (i) => first + (wide ? view.getUint16(at + 2 * i, true) : bytes[at + i]);
        indices.push(corner(0), corner(1), corner(2), corner(0), corner(2), corner(3));
      }
    }
    return { positions: new Float32Array(positions), normals: new Float32Array(normals), materials, indices: new Uint32Array(indices) };
  }

  function coloursOf(mesh, colours, deviation_um, range_um, show) {
    const out = new Uint8Array(3 * mesh.materials.length);
    let cuts = 0;
    mesh.materials.forEach((byte, v) => {
      const cut = byte & CUT;
      let colour = colours[byte & MATERIAL] || colours[0];
      if (show === "deviation") {
        const share = cut ? Math.max(-1, Math.min(1, deviation_um[cuts] / range_um)) : 0;
        colour = cut ? mix(NONE, share < 0 ? UNDER : OVER, Math.abs(share)) : NOT_CUT;
      } else if (cut) {
        colour = mix(colour, CUT_TINT, CUT_SHARE);
      }
      if (cut) ++cuts;
      out.set(colour, 3 * v);
    });
    return out;
  }

  const VERTEX = `#version 300 es
    in vec3 place; in vec3 normal; in vec3 colour; uniform mat3 turn; uniform vec3 centre, move; uniform vec2 scale; uniform vec2 depth;
    out vec3 toEye, n, tint;
    void main() {
      vec3 p = turn * (place - centre) + move;
      toEye = -p; n = turn * normal; tint = colour;
      gl_Position = vec4(p.x * scale.x, p.y * scale.y, (-p.z * (depth.x + depth.y) - 2.0 * depth.x * depth.y) / (depth.y - depth.x), -p.z);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float; in vec3 toEye, n, tint; out vec4 colour;
    void main() {
      vec3 m = normalize(n);
      if (dot(m, toEye) < 0.0) m = -m;
      float sun = max(dot(m, normalize(vec3(-0.5, 0.7, 0.8))), 0.0), sky = 0.5 + 0.5 * m.y;
      colour = vec4(tint * (0.30 + 0.16 * sky + 0.62 * sun), 1.0);
    }`;

  function programOf(gl) {
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    return gl.getProgramParameter(program, gl.LINK_STATUS) ? program : null;
  }

  // turns of the view, rows of a matrix
  const times = (a, b) => a.map((row) => [0, 1, 2].map((j) => row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j]));
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));
  function turned(rows, yaw, pitch) {
    const [c, s, d, t] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    return times([[1, 0, 0], [0, d, -t], [0, t, d]], times([[c, 0, s], [0, 1, 0], [-s, 0, c]], rows));
  }
  /** Looks along the site's axis into the opening, then tilted. */
  function startOf(axis, tilt, turn) {
    const z = unit(axis), x = unit(cross(Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], z)), y = cross(z, x);
    const [c, s] = [Math.cos(turn), Math.sin(turn)];
    const spun = [x.map((value, i) => c * value + s * y[i]), y.map((value, i) => c * value - s * x[i]), z];
    return turned(spun, 0, -tilt);
  }

  function begin(figure) {
    const canvas = figure.querySelector("canvas"), data = canvas.dataset;
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    const program = gl && programOf(gl);
    if (!program) return;
    const mesh = readChunks(bytesOf(data.surface), numbersOf(data.layout));
    if (mesh.indices.length === 0) return;
    const colours = data.colours.split(" ").map((text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16)));
    const deviation_um = data.deviation ? new Int16Array(bytesOf(data.deviation).buffer) : new Int16Array(0);
    const centre = numbersOf(data.centre), reach = Number(data.reach);
    const home = startOf(numbersOf(data.axis), Number(data.tilt), Number(data.turn));
    let rows = home, distance = reach / FIELD_OF_VIEW, shift = [0, 0];

    gl.useProgram(program);
    const attribute = (name, values, type, normalised) => {
      const buffer = gl.createBuffer(), at = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, type, normalised, 0, 0);
      return buffer;
    };
    attribute("place", mesh.positions, gl.FLOAT, false);
    attribute("normal", mesh.normals, gl.FLOAT, false);
    const tints = attribute("colour", coloursOf(mesh, colours, deviation_um, Number(data.range), data.first), gl.UNSIGNED_BYTE, true);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.indices, gl.STATIC_DRAW);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(1, 1, 1, 1);
    const at = (name) => gl.getUniformLocation(program, name);

    let asked = 0;
    function draw() {
      asked = 0;
      const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio));
      const height = Math.max(1, Math.round(canvas.clientHeight * devicePixelRatio));
      if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
      gl.viewport(0, 0, width, height);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix3fv(at("turn"), true, rows.flat());
      gl.uniform3fv(at("centre"), centre);
      gl.uniform3f(at("move"), shift[0], shift[1], -distance);
      const scale = 1 / FIELD_OF_VIEW, least = Math.min(width, height);
      gl.uniform2f(at("scale"), scale * least / width, scale * least / height);
      gl.uniform2f(at("depth"), 0.02 * distance, distance + 20 * reach);
      gl.drawElements(gl.TRIANGLES, mesh.indices.length, gl.UNSIGNED_INT, 0);
    }
    const redraw = () => { asked = asked || requestAnimationFrame(draw); };

    const pointers = new Map();
    canvas.onpointerdown = (event) => {
      pointers.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
    };
    canvas.onpointerup = canvas.onpointercancel = (event) => pointers.delete(event.pointerId);
    const zoom = (factor) => { distance = Math.max(0.1 * reach, Math.min(12 * reach, distance * factor)); };
    canvas.onpointermove = (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      const other = [...pointers.values()].find((each) => each.pointerId !== event.pointerId);
      if (other) {
        const span = (each) => Math.hypot(each.clientX - other.clientX, each.clientY - other.clientY);
        zoom(span(before) / Math.max(span(event), 1));
      } else if (event.shiftKey || event.buttons === 2) {
        const step = 2 * FIELD_OF_VIEW * distance / Math.min(canvas.clientWidth, canvas.clientHeight);
        shift = [shift[0] + step * dx, shift[1] - step * dy];
      } else {
        rows = turned(rows, 0.008 * dx, 0.008 * dy);
      }
      pointers.set(event.pointerId, event);
      redraw();
    };
    canvas.oncontextmenu = (event) => event.preventDefault();
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      zoom(Math.exp(0.0012 * event.deltaY));
      redraw();
    }, { passive: false });
    canvas.onkeydown = (event) => {
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
      if (turns) rows = turned(rows, ...turns);
      else if (event.key === "+") zoom(0.9);
      else if (event.key === "-") zoom(1.1);
      else return;
      event.preventDefault();
      redraw();
    };
    for (const button of figure.querySelectorAll("button"))
      button.onclick = () => {
        if (button.dataset.show) {
          gl.bindBuffer(gl.ARRAY_BUFFER, tints);
          gl.bufferData(gl.ARRAY_BUFFER, coloursOf(mesh, colours, deviation_um, Number(data.range), button.dataset.show), gl.STATIC_DRAW);
          for (const each of figure.querySelectorAll("[data-show]")) each.setAttribute("aria-pressed", String(each === button));
          for (const each of figure.querySelectorAll("[data-with]")) each.hidden = each.dataset.with !== button.dataset.show;
        } else {
          [rows, distance, shift] = [home, reach / FIELD_OF_VIEW, [0, 0]];
        }
        redraw();
      };
    const scale = figure.querySelector(".scale i"), rgb = (colour) => `rgb(${colour.join()})`;
    if (scale) scale.style.background = `linear-gradient(90deg, ${rgb(UNDER)}, ${rgb(NONE)}, ${rgb(OVER)})`;
    figure.hidden = false;
    new ResizeObserver(redraw).observe(canvas);
    redraw();
  }
  for (const figure of document.querySelectorAll("figure.turn")) begin(figure);
})();
