// Light probes as three.js's own LightProbeGenerator computes them, without a browser.
//
//   npm install three@0.187.0
//   node tools/three_light_probe.mjs FACES.f32 SIZE
//
// FACES.f32: 6 × SIZE × SIZE × RGB little-endian float32, +X −X +Y −Y +Z −Z, row 0 first in memory.
// Prints JSON: version, and 27 coefficients twice. `target` is fromCubeRenderTarget of a WebGL
// renderer with a float target, which hands back these faces. `texture` is fromCubeTexture of the
// same light, cut at 1 and encoded as 8-bit sRGB, x mirrored as that function wants it; the canvas
// that it draws on hands back the bytes.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { pathToFileURL } from "node:url";

// Of the working directory, where npm installed it; its ES module, as the generator imports it.
const require = createRequire(join(process.cwd(), "package.json"));
const module = join(dirname(require.resolve("three")), "three.module.js");
const THREE = await import(pathToFileURL(module).href);
const generator = require.resolve("three/addons/lights/LightProbeGenerator.js");
const { LightProbeGenerator } = await import(pathToFileURL(generator).href);

const [path, sizeText] = process.argv.slice(2);
const size = Number(sizeText);
const bytes = readFileSync(path);
const light = new Float32Array(bytes.buffer, bytes.byteOffset, 6 * size * size * 3);

function face(index, encode, mirrored) {
  const Type = encode ? Uint8ClampedArray : Float32Array;
  const data = new Type(size * size * 4);
  for (let row = 0; row < size; row++) {
    for (let column = 0; column < size; column++) {
      const from = mirrored ? size - 1 - column : column;
      for (let channel = 0; channel < 3; channel++) {
        const value = light[((index * size + row) * size + from) * 3 + channel];
        data[(row * size + column) * 4 + channel] = encode ? encode(value) : value;
      }
    }
  }
  return data;
}

const renderer = {
  isWebGLRenderer: true,
  coordinateSystem: THREE.WebGLCoordinateSystem,
  async readRenderTargetPixelsAsync(target, x, y, width, height, data, index) {
    data.set(face(index));
  },
};
const target = {
  width: size,
  texture: { type: THREE.FloatType, colorSpace: THREE.LinearSRGBColorSpace },
};

const srgb8 = (value) => {
  const cut = Math.min(1, value);
  const code = cut <= 0.0031308 ? 12.92 * cut : 1.055 * Math.pow(cut, 1 / 2.4) - 0.055;
  return Math.round(255 * code);
};
globalThis.document = {
  createElement: () => ({
    getContext() {
      let drawn;
      return {
        drawImage: (image) => (drawn = image),
        getImageData: () => drawn,
      };
    },
  }),
};
// In a world with x mirrored our +X is its −X, and every picture is turned left to right.
const mirrored = [1, 0, 2, 3, 4, 5].map((index) => ({
  width: size,
  height: size,
  data: face(index, srgb8, true),
}));
const texture = { image: mirrored, colorSpace: THREE.SRGBColorSpace };

const [fromTarget, fromTexture] = [
  await LightProbeGenerator.fromCubeRenderTarget(renderer, target),
  LightProbeGenerator.fromCubeTexture(texture),
];
console.log(
  JSON.stringify({
    three: THREE.REVISION,
    target: fromTarget.sh.toArray(),
    texture: fromTexture.sh.toArray(),
  }),
);
