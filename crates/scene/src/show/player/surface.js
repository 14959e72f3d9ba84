// The surface: faces, lines and balls in WebGL with a depth buffer, so that the near covers the far and
// what passes through each other is seen to. Where there is no WebGL the painter draws instead.

// A program, and the places of its inputs.
const program = (gl, sources) => {
  const made = gl.createProgram();
  sources.forEach((source, k) => {
    const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  });
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) return null;
  const inputs = { program: made };
  for (let k = 0; k < gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS); k++) {
    const name = gl.getActiveUniform(made, k).name.replace("[0]", "");
    inputs[name] = gl.getUniformLocation(made, name);
  }
  return inputs;
};

// A mesh of the graphics card: numbers for inputs, as many of them at a time as each wants.
const mesh = (gl, inputs, wanted) => {
  const made = { own: gl.createVertexArray(), buffer: gl.createBuffer(), numbers: 0, count: 0 };
  gl.bindVertexArray(made.own);
  gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
  made.numbers = Object.values(wanted).reduce((sum, size) => sum + size, 0);
  let before = 0;
  for (const [name, size] of Object.entries(wanted)) {
    const place = gl.getAttribLocation(inputs.program, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * made.numbers, 4 * before);
    before += size;
  }
  return made;
};

// Gives a mesh its numbers; it is drawn next.
const fill = (gl, made, numbers) => {
  gl.bindVertexArray(made.own);
  gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
  made.count = numbers.length / made.numbers;
};

// Numbers of a corner: its place, its value and its hue.
const CORNER = 5;

// WebGL, and whether a graphics card draws. Where a processor does, edges are not smooth, which would take
// twice the time, and what plays has half as many pixels each way.
const granted = () => {
  const trial = document.createElement("canvas").getContext("webgl2");
  if (!trial) return {};
  const told = trial.getExtension("WEBGL_debug_renderer_info");
  const drawnBy = told ? trial.getParameter(told.UNMASKED_RENDERER_WEBGL) : "";
  trial.getExtension("WEBGL_lose_context")?.loseContext();
  const card = !/swiftshader|llvmpipe|basic render/i.test(drawnBy);
  return { gl: sheet.getContext("webgl2", { stencil: true, antialias: card }), card };
};

// What draws the surface, or nothing where there is no WebGL or no surface.
const opened = () => {
  const { gl, card } = SOLID ? granted() : {};
  if (!gl) return null;
  const [faces, lines, round] = [FACES, LINES, BALLS].map((sources) => program(gl, sources));
  if (!faces || !lines || !round) return null;
  gl.enable(gl.DEPTH_TEST);
  gl.depthFunc(gl.LEQUAL);
  gl.enable(gl.BLEND);
  gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  sheet.addEventListener("webglcontextlost", () => {
    surface = null;
    behind.hidden = sheet.hidden = true;
    redraw();
  });
  return {
    gl, card, faces, lines, round,
    corners: new Float32Array(CORNER * 3 * (motion.faces.length / 4)),
    shape: mesh(gl, faces, { corner: 4, tint: 1 }),
    strokes: mesh(gl, lines, { start: 3, end: 3 }),
    balls: mesh(gl, round, { ball: 4, turn: 4, paint: 4 }),
  };
};
let surface = opened();
sheet.hidden = !surface;

// A colour as the graphics card has it.
const unit = (text) => hex(text).map((part) => part / 255);

// A program that is told where the eye is.
const used = (inputs) => {
  const { gl } = surface;
  const [right, up, eye] = axes();
  const scale = camera.fit * camera.zoom;
  const { width, height } = stage;
  gl.useProgram(inputs.program);
  gl.uniformMatrix3fv(inputs.view, false, [...right, ...up, ...eye]);
  gl.uniform3fv(inputs.target, camera.target.map((x, c) => x - data.origin[c]));
  gl.uniform4f(inputs.window, (2 * scale) / width, (2 * scale) / height, (2 * camera.pan[0]) / width, 1 - (2 * (stage.middle + camera.pan[1])) / height);
  gl.uniform2f(inputs.span, width, height);
  gl.uniform1f(inputs.distance, EYE * camera.radius);
  gl.uniform1i(inputs.spatial, spatial);
  gl.uniform2f(inputs.lights, AMBIENT, SUNLIGHT);
  return inputs;
};

// The corners of all faces, where they are now.
const placeCorners = () => {
  const { faces, points, values } = motion;
  const { corners } = surface;
  const [x, y, z] = data.origin;
  for (let k = 0, n = 0; k < faces.length; k++) {
    if (k % 4 === 3) continue;
    const i = faces[k];
    corners[n++] = points[3 * i] - x;
    corners[n++] = points[3 * i + 1] - y;
    corners[n++] = points[3 * i + 2] - z;
    corners[n++] = data.field ? along(values[i]) : 0;
    corners[n++] = faces[k | 3] % COLOURS;
  }
  return corners;
};

const drawFaces = () => {
  const { gl, shape } = surface;
  if (!motion.faces.length) return;
  const inputs = used(surface.faces);
  gl.uniform3fv(inputs.tints, tints().flat().map((part) => part / 255));
  gl.uniform3fv(inputs.ramp, RAMP.flat().map((part) => part / 255));
  gl.uniform1i(inputs.field, data.field !== null);
  gl.uniform4f(inputs.wire, ...unit(wireInk()), data.wired ? WIRE : 0);
  gl.uniform4f(inputs.shade, ...unit(stage.colours.muted), SHADOW);
  fill(gl, shape, placeCorners());
  if (spatial && data.floor !== null) {
    // Once, however many faces are above.
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 1);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.depthMask(false);
    gl.uniform1i(inputs.shadow, true);
    gl.uniform1f(inputs.ground, data.floor - data.origin[2]);
    gl.drawArrays(gl.TRIANGLES, 0, shape.count);
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
  }
  gl.uniform1i(inputs.shadow, false);
  gl.drawArrays(gl.TRIANGLES, 0, shape.count);
};

// From numbers of each thing to those of each of its six corners.
const sixfold = (numbers, each) => {
  const found = new Float32Array(6 * numbers.length);
  for (let k = 0; k < found.length; k++) found[k] = numbers[Math.floor(k / (6 * each)) * each + (k % each)];
  return found;
};

const drawStrokes = () => {
  const { gl, strokes } = surface;
  const inputs = used(surface.lines);
  for (const { ends, style, width } of solidLines()) {
    if (!ends.length) continue;
    const numbers = new Float32Array(3 * ends.length);
    for (let k = 0; k < numbers.length; k++)
      numbers[k] = motion.points[3 * ends[Math.floor(k / 3)] + (k % 3)] - data.origin[k % 3];
    gl.uniform1f(inputs.width, width);
    gl.uniform1f(inputs.lift, LIFT * camera.radius);
    gl.uniform4f(inputs.paint, ...unit(style), 1);
    fill(gl, strokes, sixfold(numbers, strokes.numbers));
    gl.drawArrays(gl.TRIANGLES, 0, strokes.count);
  }
};

const drawRound = () => {
  const { gl } = surface;
  if (!spatial) return;
  const [, , eye] = axes();
  const all = balls().flatMap(({ at, radius, style, turns, number }) => {
    const near = dot(eye, at.map((x, c) => x - camera.target[c]));
    const size = Math.max(radius, 2 / magnified(near));
    const turn = turns ? motion.turns.subarray(4 * number, 4 * number + 4) : [1, 0, 0, 0];
    return [...at.map((x, c) => x - data.origin[c]), size, ...turn, ...unit(style), turns ? 1 : 0];
  });
  if (!all.length) return;
  used(surface.round);
  fill(gl, surface.balls, sixfold(all, surface.balls.numbers));
  gl.drawArrays(gl.TRIANGLES, 0, surface.balls.count);
};

const drawSurface = () => {
  const { gl, card } = surface;
  const share = now.playing && !card ? 0.5 : 1;
  const [width, height] = [canvas.width, canvas.height].map((pixels) => Math.max(1, Math.round(share * pixels)));
  if (sheet.width !== width || sheet.height !== height) [sheet.width, sheet.height] = [width, height];
  gl.viewport(0, 0, sheet.width, sheet.height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
  drawFaces();
  drawStrokes();
  drawRound();
};
