// Presses a ball of tissue and prints force over depth: a table that any program reads.
// usage: node node.mjs      after `npm install pellicle-*.tgz`
import { load } from "pellicle";

const pellicle = await load();
const simulation = pellicle.simulation(`
version: 1
bodies:
  - { name: ball, mesh: { shape: geodesic-sphere, frequency: 8, radius: 0.05 }, mass: { density: 1000 }, springs: { young: 20000 }, volumetric: { young: 5000 },
      pinned: { plane: { point: [0, 0, -0.04], normal: [0, 0, -1] } } }
tools:
  - { name: finger, shape: sphere, radius: 0.015, motion: [ { time: 0, position: { above: highest } }, { time: 1, position: { above: highest, by: -0.01 } } ] }
duration: 1
`);
console.log("depth_m,force_N");
for (let i = 1; i <= 10; i++) {
    simulation.step(10);
    const [finger] = simulation.summary().tools;
    console.log(`${(0.001 * i).toFixed(3)},${Math.hypot(...finger.force).toFixed(4)}`);
}
simulation.dispose();
