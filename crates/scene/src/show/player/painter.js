// The painter: solids on a canvas of two dimensions, far ones first, so that the near ones cover them.
// Where faces pass through each other one covers the other.

// How much light a face of a body in space gets, whose eye and sun are in these directions.
const light = ([a, b, c], eye, sun) => {
  const p = motion.points;
  const [ux, uy, uz] = [p[3 * b] - p[3 * a], p[3 * b + 1] - p[3 * a + 1], p[3 * b + 2] - p[3 * a + 2]];
  const [vx, vy, vz] = [p[3 * c] - p[3 * a], p[3 * c + 1] - p[3 * a + 1], p[3 * c + 2] - p[3 * a + 2]];
  const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const size = Math.sqrt(dot(normal, normal)) || 1;
  const lit = ((dot(normal, eye) < 0 ? -1 : 1) * dot(normal, sun)) / size;
  return AMBIENT + SUNLIGHT * Math.max(0, lit);
};

// How much of a face's colour is its body's, and how much that of all faces.
const TINT = 0.35;
const tints = () => {
  const base = hex(stage.colours.face);
  return Array.from({ length: COLOURS }, (_, k) => hex(colour(k)).map((own, i) => TINT * own + (1 - TINT) * base[i]));
};

// How much of the ink the sides of faces have; on dark paper too they are dark where colours are read.
const WIRE = data.field ? 0.1 : 0.4;
const wireInk = () => (data.field ? "#000000" : stage.colours.ink);

// How far lines stand before the faces that they bound, in radii of the scene.
const LIFT = 0.02;

// A painter of faces, given their corners and their body.
const faceBrush = () => {
  const { x, y } = seen;
  const { values } = motion;
  const [right, up, eye] = axes();
  const sun = [0, 1, 2].map((c) => SUN[0] * right[c] + SUN[1] * up[c] + SUN[2] * eye[c]);
  const [hues, ink] = [tints(), hex(wireInk())];
  return (corners) => {
    const [a, b, c, body] = corners;
    const lit = spatial ? light(corners, eye, sun) : 1;
    const plain = data.field ? shade((values[a] + values[b] + values[c]) / 3) : hues[body % COLOURS];
    const own = plain.map((part) => lit * part);
    pen.beginPath();
    pen.moveTo(x[a], y[a]);
    pen.lineTo(x[b], y[b]);
    pen.lineTo(x[c], y[c]);
    pen.closePath();
    pen.fillStyle = rgb(own);
    pen.fill();
    // Without a line neighbours would leave a hair between them.
    pen.strokeStyle = data.wired ? rgb(own.map((part, i) => (1 - WIRE) * part + WIRE * ink[i])) : pen.fillStyle;
    pen.lineWidth = 0.8;
    pen.stroke();
  };
};

const paintSolids = (project) => {
  const { x, y, near } = seen;
  const { faces } = motion;
  const paintFace = faceBrush();
  const pieces = [];
  for (let k = 0; k < faces.length; k += 4) {
    const depth = (near[faces[k]] + near[faces[k + 1]] + near[faces[k + 2]]) / 3;
    pieces.push({ depth, paint: () => paintFace(faces.subarray(k, k + 4)) });
  }
  for (const { ends, style, width } of solidLines())
    for (let k = 0; k < ends.length; k += 2) {
      const [a, b] = [ends[k], ends[k + 1]];
      const paint = () => {
        pen.beginPath();
        pen.moveTo(x[a], y[a]);
        pen.lineTo(x[b], y[b]);
        [pen.strokeStyle, pen.lineWidth] = [style, width];
        pen.stroke();
      };
      pieces.push({ depth: 0.5 * (near[a] + near[b]) + LIFT * camera.radius, paint });
    }
  for (const ball of spatial ? balls() : []) {
    const at = project(...ball.at);
    pieces.push({ depth: at[2], paint: () => drawBall(ball, at) });
  }
  if (spatial) pieces.sort((one, other) => one.depth - other.depth);
  pieces.forEach((piece) => piece.paint());
};
