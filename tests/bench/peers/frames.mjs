// SPDX-License-Identifier: Apache-2.0
// In-betweens of pairs of rings by each library.
//
// Reads {"pairs": [{"a": [[x, y], ...], "b": ...}], "times": [0..1, ...]} from standard input, writes
// {library: [per pair: {"rings": [per time: ring], "microseconds": of a frame} or {"error": text}]}.
// Vertex k of all rings of a pair is the same moving point.  A frame is timed as the library gives
// it, a path or points, once its code is warm.

import * as polymorph from 'polymorph-js';
import { compile, morph } from 'svg-path-morph';
import { interpolatePath } from 'd3-interpolate-path';
import flubber from 'flubber';
import { readFileSync } from 'node:fs';

// Makes a ring of so many points, evenly along it: svg-path-morph wants equal numbers.
const EVEN_POINTS = 200;

const pathOf = (ring) => 'M' + ring.map(([x, y]) => `${x},${y}`).join('L') + 'Z';

// Ends of the segments of a path of absolute M, L and C; an e is part of a number.
function ringOf(path) {
  const ring = [];
  for (const [, command, numbers] of path.matchAll(/([A-DF-Za-df-z])([^A-DF-Za-df-z]*)/g)) {
    const values = numbers.match(/-?[\d.]+(?:e[-+]?\d+)?/gi)?.map(Number) ?? [];
    const step = { M: 2, L: 2, C: 6, Z: 0, z: 0 }[command];
    if (step === undefined) throw new Error(`unexpected command ${command}`);
    for (let k = step; step > 0 && k <= values.length; k += step) {
      ring.push([values[k - 2], values[k - 1]]);
    }
  }
  return ring;
}

function evenly(ring) {
  const closed = [...ring, ring[0]];
  const lengths = ring.map(([x, y], k) => Math.hypot(closed[k + 1][0] - x, closed[k + 1][1] - y));
  const total = lengths.reduce((sum, length) => sum + length, 0);
  const even = [];
  let edge = 0, before = 0;
  for (let k = 0; k < EVEN_POINTS; ++k) {
    const at = (total * k) / EVEN_POINTS;
    while (edge + 1 < ring.length && before + lengths[edge] < at) before += lengths[edge++];
    const share = (at - before) / lengths[edge];
    even.push([0, 1].map((c) => closed[edge][c] + share * (closed[edge + 1][c] - closed[edge][c])));
  }
  return even;
}

const asItIs = (ring) => ring;

// How each makes its interpolator of a pair, and how a ring is read from what that gives.
const libraries = {
  flubber: {
    prepare: ({ a, b }) => flubber.interpolate(a, b, { string: false, maxSegmentLength: 4 }),
    read: asItIs,
  },
  'polymorph-js': {
    prepare: ({ a, b }) => polymorph.interpolate([pathOf(a), pathOf(b)], { precision: 6 }),
    read: ringOf,
  },
  'svg-path-morph': {
    prepare: ({ a, b }) => {
      const both = compile([pathOf(evenly(a)), pathOf(evenly(b))]);
      return (t) => morph(both, [1 - t, t]);
    },
    read: ringOf,
  },
  'd3-interpolate-path': {
    prepare: ({ a, b }) => interpolatePath(pathOf(a), pathOf(b)),
    read: ringOf,
  },
};

// The median over rounds, each of a few milliseconds at the least.
function microsecondsOf(between) {
  const rounds = 9, leastMilliseconds = 4;
  const found = [];
  for (let round = 0; round < rounds; ++round) {
    const start = performance.now();
    let count = 0;
    while (performance.now() - start < leastMilliseconds) between((++count % 97) / 97);
    found.push((1000 * (performance.now() - start)) / count);
  }
  return found.sort((x, y) => x - y)[(rounds - 1) / 2];
}

const { pairs, times } = JSON.parse(readFileSync(0, 'utf8'));
const answer = {};
for (const [name, { prepare, read }] of Object.entries(libraries)) {
  answer[name] = pairs.map((pair) => {
    try {
      const between = prepare(pair);
      const rings = times.map((t) => read(between(t)));
      return { rings, microseconds: microsecondsOf(between) };
    } catch (error) {
      return { error: String(error) };
    }
  });
}
process.stdout.write(JSON.stringify(answer));
