// A .glb of spheres in a row along x, of radius 0.9 and 2 apart: metals of the given roughness, then a matte one.
export function spheresGlb(roughness) {
  const SEGMENTS = 64, RINGS = 32, positions = [], indices = [];
  for (let j = 0; j <= RINGS; ++j) for (let i = 0; i <= SEGMENTS; ++i) {
    const [t, p] = [(Math.PI * j) / RINGS, (2 * Math.PI * i) / SEGMENTS];
    positions.push(Math.sin(t) * Math.sin(p), Math.cos(t), Math.sin(t) * Math.cos(p));
  }
  for (let j = 0; j < RINGS; ++j) for (let i = 0; i < SEGMENTS; ++i) {
    const a = j * (SEGMENTS + 1) + i, b = a + SEGMENTS + 1;
    indices.push(a, b, a + 1, a + 1, b, b + 1);
  }
  const vertices = Buffer.from(new Float32Array(positions).buffer), faces = Buffer.from(new Uint16Array(indices).buffer);
  const materials = roughness.map((roughnessFactor) => ({ pbrMetallicRoughness: { roughnessFactor, metallicFactor: 1 } }));
  materials.push({ pbrMetallicRoughness: { roughnessFactor: 1, metallicFactor: 0 } });
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: materials.map((_, i) => i) }],
    nodes: materials.map((_, i) => ({ mesh: i, translation: [2 * i - materials.length + 1, 0, 0], scale: [0.9, 0.9, 0.9] })),
    meshes: materials.map((_, i) => ({ primitives: [{ attributes: { POSITION: 0, NORMAL: 0 }, indices: 1, material: i }] })),
    materials,
    accessors: [
      { bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3", min: [-1, -1, -1], max: [1, 1, 1] },
      { bufferView: 1, componentType: 5123, count: indices.length, type: "SCALAR" },
    ],
    bufferViews: [
      { buffer: 0, byteOffset: 0, byteLength: vertices.length, target: 34962 },
      { buffer: 0, byteOffset: vertices.length, byteLength: faces.length, target: 34963 },
    ],
    buffers: [{ byteLength: vertices.length + faces.length }],
  };
  let text = JSON.stringify(json);
  text += " ".repeat((4 - (text.length % 4)) % 4);
  const head = Buffer.alloc(20), middle = Buffer.alloc(8);
  head.write("glTF");
  head.writeUInt32LE(2, 4);
  head.writeUInt32LE(28 + text.length + vertices.length + faces.length, 8);
  head.writeUInt32LE(text.length, 12);
  head.write("JSON", 16);
  middle.writeUInt32LE(vertices.length + faces.length, 0);
  middle.write("BIN\0", 4);
  return Buffer.concat([head, Buffer.from(text), middle, vertices, faces]);
}
