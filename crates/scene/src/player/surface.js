// The surface: faces, lines and balls in WebGL with a depth buffer, so that the near covers the far and
// what passes through each other is seen to. Where there is no WebGL the painter draws instead.
//
// One perspective for all, that of the camera's `projector`; places count from the middle:
//
//   w = (D - n) / D      n nearness to the eye, D its distance from the target; 1 in a plane
//   depth = A + B / w    -1 at w = NEAREST, 1 at w = FARTHEST
const [NEAREST, FARTHEST] = [0.1, 4];

const VIEW = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform mat3 view;
uniform vec3 target;
uniform vec2 span;
uniform vec4 window;
uniform float distance;
uniform bool spatial;
float depth(float w) {
  return ${((FARTHEST + NEAREST) / (FARTHEST - NEAREST)).toFixed(9)} - ${((2 * FARTHEST * NEAREST) / (FARTHEST - NEAREST)).toFixed(9)} / w;
}
float far(float near) { return spatial ? (distance - near) / distance : 1.0 - near / distance; }
vec4 clip(vec3 seen, float lift) {
  float w = spatial ? far(seen.z) : 1.0;
  return vec4(window.xy * seen.xy + window.zw * w, depth(far(seen.z + lift)) * w, w);
}
const vec3 SUN = vec3(${SUN});
uniform vec2 lights;
`;

// Faces: a corner is where a particle is, with the value of the field there and the hue of its body. What
// is near a side, in pixels, is darker. A shadow is the same on the floor.
const FACES = [`${VIEW}
in vec4 corner;
in float tint;
uniform vec3 tints[${COLOURS}];
uniform float ground;
uniform bool shadow;
out vec3 seen, own, side;
out float value;
void main() {
  int k = gl_VertexID % 3;
  side = vec3(k == 0, k == 1, k == 2);
  seen = (vec3(corner.xy, shadow ? ground : corner.z) - target) * view;
  own = tints[int(tint)];
  value = corner.w;
  gl_Position = clip(seen, 0.0);
}`, `${VIEW}
in vec3 seen, own, side;
in float value;
uniform vec3 ramp[${RAMP.length}];
uniform bool field, shadow;
uniform vec4 shade, wire;
out vec4 colour;
void main() {
  if (shadow) { colour = vec4(shade.rgb * shade.a, shade.a); return; }
  vec3 paint = own;
  if (field) {
    float along = clamp(value, 0.0, 1.0) * ${RAMP.length - 1}.0;
    int low = min(${RAMP.length - 2}, int(along));
    paint = mix(ramp[low], ramp[low + 1], along - float(low));
  }
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = spatial ? lights.x + lights.y * max(0.0, sign(normal.z) * dot(normal, SUN)) : 1.0;
  vec3 far = side / fwidth(side);
  float near = wire.a * (1.0 - smoothstep(0.1, 0.9, min(far.x, min(far.y, far.z))));
  colour = vec4(mix(light * paint, wire.rgb, near), 1);
}`];

// Lines between two particles, as wide as asked.
const LINES = [`${VIEW}
in vec3 start, end;
uniform float width, lift;
void main() {
  int k = gl_VertexID % 6;
  vec4 a = clip((start - target) * view, lift), b = clip((end - target) * view, lift);
  vec2 way = (b.xy / b.w - a.xy / a.w) * span;
  vec2 across = normalize(vec2(-way.y, way.x) + vec2(1e-9, 0)) * (k == 2 || k == 4 || k == 5 ? 1.0 : -1.0);
  gl_Position = k == 1 || k == 2 || k == 4 ? b : a;
  gl_Position.xy += across * width / span * gl_Position.w;
}`, `${VIEW}
uniform vec4 paint;
out vec4 colour;
void main() { colour = paint; }`];

// Balls: a square before each, in which every pixel looks for the ball along its line of sight. Those
// that turn have darker octants.
const BALLS = [`${VIEW}
in vec4 ball;
in vec4 turn;
in vec4 paint;
out vec3 place;
flat out vec4 around, turning, own;
void main() {
  int k = gl_VertexID % 6;
  vec2 corner = vec2(k == 1 || k == 2 || k == 4 ? 1 : -1, k == 2 || k == 4 || k == 5 ? 1 : -1);
  around = vec4((ball.xyz - target) * view, ball.w);
  place = around.xyz + vec3(1.4 * ball.w * corner, 0);
  turning = turn;
  own = paint;
  gl_Position = clip(place, 0.0);
}`, `${VIEW}
in vec3 place;
flat in vec4 around, turning, own;
out vec4 colour;
vec3 turned(vec4 q, vec3 x) { return x + 2.0 * cross(q.yzw, cross(q.yzw, x) + q.x * x); }
void main() {
  vec3 from = vec3(0, 0, distance) - around.xyz, way = normalize(place - vec3(0, 0, distance));
  float middle = dot(from, way), miss = length(from - middle * way), edge = fwidth(miss);
  float inside = clamp((around.w - miss) / edge + 0.5, 0.0, 1.0);
  if (inside == 0.0) discard;
  vec3 hit = from - (middle + sqrt(max(0.0, around.w * around.w - miss * miss))) * way;
  vec3 normal = hit / around.w;
  float light = lights.x + lights.y * max(0.0, dot(normal, SUN));
  // A quaternion turns body axes into the world's, and this one back.
  vec3 body = turned(vec4(turning.x, -turning.yzw), view * normal);
  vec3 signs = clamp(body / max(fwidth(body), 1e-6), -1.0, 1.0);
  float mark = own.a * (0.5 - 0.5 * signs.x * signs.y * signs.z);
  vec3 seen = around.xyz + hit;
  gl_FragDepth = 0.5 + 0.5 * depth(far(seen.z));
  colour = vec4(light * mix(own.rgb, 0.55 * own.rgb, mark), 1) * inside;
}`];

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

// Gives a mesh its numbers, and the program and the mesh the next turn.
const fill = (gl, made, numbers) => {
  gl.bindVertexArray(made.own);
  gl.bindBuffer(gl.ARRAY_BUFFER, made.buffer);
  gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
  made.count = numbers.length / made.numbers;
};

// Numbers of a corner: its place, its value and its hue.
const CORNER = 5;

// WebGL, with smooth edges where a graphics card draws: a processor takes twice the time for them.
const granted = () => {
  const trial = document.createElement("canvas").getContext("webgl2");
  if (!trial) return null;
  const told = trial.getExtension("WEBGL_debug_renderer_info");
  const drawnBy = told ? trial.getParameter(told.UNMASKED_RENDERER_WEBGL) : "";
  trial.getExtension("WEBGL_lose_context")?.loseContext();
  return sheet.getContext("webgl2", { stencil: true, antialias: !/swiftshader|llvmpipe|basic render/i.test(drawnBy) });
};

const opened = () => {
  const gl = SOLID ? granted() : null;
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
    gl, faces, lines, round,
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
  const base = unit(stage.colours.face);
  const tints = Array.from({ length: COLOURS }, (_, k) => unit(colour(k)).map((own, i) => TINT * own + (1 - TINT) * base[i]));
  gl.uniform3fv(inputs.tints, tints.flat());
  gl.uniform3fv(inputs.ramp, RAMP.flat().map((part) => part / 255));
  gl.uniform1i(inputs.field, data.field !== null);
  gl.uniform4f(inputs.wire, ...unit(stage.colours.ink), data.wired ? WIRE : 0);
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
  const { gl } = surface;
  if (sheet.width !== canvas.width || sheet.height !== canvas.height) [sheet.width, sheet.height] = [canvas.width, canvas.height];
  gl.viewport(0, 0, sheet.width, sheet.height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
  drawFaces();
  drawStrokes();
  drawRound();
};
