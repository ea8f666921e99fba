// The channel to a simulation in a worker (worker.js), with the messages of wire.js.
import { readMessage } from "./wire.js";
import SimulationWorker from "./worker.js?worker&inline";

export class WorkerWire {
    // start: promise of { core, scene, files, paused }; received(message) and changed(why) as in wire.js
    constructor(start, received, changed) {
        const fail = (error) => changed(`The simulation cannot run: ${error.message}`);
        this.worker = new SimulationWorker();
        this.worker.onerror = fail;
        this.worker.onmessage = ({ data }) => {
            if (data.failure) fail(data.failure);
            else received(readMessage(data));
        };
        start.then(({ core, ...page }) => this.worker.postMessage({ core, ...page }, [core.buffer])).catch(fail);
    }

    send(line) {
        this.worker.postMessage(line);
    }
}
