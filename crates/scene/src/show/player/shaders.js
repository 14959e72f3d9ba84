// The programs of the graphics card. One perspective for all, that of the camera's `projector`; places
// count from the middle:
//
//   w = (D - n) / D      n nearness to the eye, D its distance from the target; 1 in a plane
//   depth = A + B / w    -1 at w = NEAREST, 1 at w = FARTHEST
const [NEAREST, FARTHEST] = [0.1, 4];

const VIEW = `#version 300 es
precision highp float;
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
