// Messages of the player (src/service/live/message.h), and the channel to the program that serves the page.

// { head, take }: the JSON head, and a function that reads the next array of the buffer
function readBinary(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    let at = 4 + length;
    const take = (Kind, count) => {
        const array = new Kind(buffer, at, count);
        at += Math.ceil((count * Kind.BYTES_PER_ELEMENT) / 4) * 4;
        return array;
    };
    return { head, take };
}

function readSurface({ head, take }) {
    if (head.tool) head.tool = { positions: take(Float32Array, 3 * head.tool.vertices), triangles: take(Uint32Array, 3 * head.tool.triangles) };
    head.bodies = head.bodies.map(({ vertices, triangles, pins }) => ({
        vertices,
        corners: take(Uint32Array, 3 * triangles),
        pins: take(Uint8Array, pins),
    }));
    return head;
}

function readFrame({ head, take }) {
    head.bodies = head.bodies.map((count) => ({
        positions: take(Float32Array, 3 * count),
        values: head.field ? take(Float32Array, count) : null,
        contacts: take(Uint8Array, count),
    }));
    return head;
}

// { type, ... } of a text or an ArrayBuffer
export function readMessage(data) {
    if (typeof data === "string") return JSON.parse(data);
    const message = readBinary(data);
    return message.head.type === "surface" ? readSurface(message) : readFrame(message);
}

export class Wire {
    // received(message) gets { type, ... }; changed(why) gets "" when the connection opens, or the reason why there is none
    constructor(received, changed) {
        this.received = received;
        this.changed = changed;
        this.waiting = 250;
        this.connect();
    }

    connect() {
        this.socket = new WebSocket(`ws://${location.host}/`, "pellicle");
        this.socket.binaryType = "arraybuffer";
        this.socket.onopen = () => {
            this.waiting = 250;
            this.changed("");
        };
        this.socket.onclose = () => {
            this.changed(
                "The program has ended or cannot be reached. If it still runs, this page reconnects. Otherwise run pellicle live again and use the page that it opens.",
            );
            setTimeout(() => this.connect(), this.waiting);
            this.waiting = Math.min(2 * this.waiting, 4000);
        };
        this.socket.onmessage = ({ data }) => this.received(readMessage(data));
    }

    send(line) {
        if (this.socket.readyState === WebSocket.OPEN) this.socket.send(line);
    }
}
