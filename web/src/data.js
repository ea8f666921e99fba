// Reads the runs from the page. src/runs/report/encode.c and report/describe.c write them.

// size of a frame in the stream [bytes]
function frameSize(run, frame, known) {
    const [vertices, triangles] = run.topologies[frame.topology];
    const values = run.fields.reduce((sum, field) => sum + (field.channels * field.bits) / 8, 6);
    return vertices * values + (known.has(frame.topology) ? 0 : 12 * triangles);
}

// 0, 1, 2, 3, ... encode 0, -1, 1, -2, ...
const unfold = (folded) => (folded >>> 1) ^ -(folded & 1);

function readCorners(bytes, count) {
    const corners = new Uint32Array(count);
    let last = 0;
    for (let i = 0; i < count; i++) {
        const folded = bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24);
        last = (last + unfold(folded)) >>> 0;
        corners[i] = last;
    }
    return corners;
}

// reads a list of differences and adds it to the list of the previous frame (or to 0 if that is null)
function readChannel(bytes, numbers, before, begin, count, bits) {
    const mask = bits === 16 ? 0xffff : 0xff;
    for (let v = 0; v < count; v++) {
        const folded = bits === 16 ? bytes[v] | (bytes[count + v] << 8) : bytes[v];
        numbers[begin + v] = ((before ? before[begin + v] : 0) + unfold(folded)) & mask;
    }
}

function decodeFrame(run, index, bytes) {
    const frame = run.frames[index];
    const [vertices, triangles] = run.topologies[frame.topology];
    let at = 0;
    if (!run.corners[frame.topology]) {
        run.corners[frame.topology] = readCorners(bytes, 3 * triangles);
        at = 12 * triangles;
    }
    const channels = run.fields.reduce((sum, field) => sum + field.channels, 3);
    const numbers = new Uint16Array(channels * vertices);
    const last = run.frames[index - 1];
    const before = last && last.topology === frame.topology ? last.numbers : null;
    for (let channel = 0; channel < channels; channel++) {
        const bits = run.channelBits[channel];
        readChannel(bytes.subarray(at), numbers, before, channel * vertices, vertices, bits);
        at += (vertices * bits) / 8;
    }
    frame.numbers = numbers;
    run.ready = index + 1;
}

export function fromBase64(text) {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const binary = atob(text);
    const bytes = new Uint8Array(binary.length);
    for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
    return bytes;
}

// decodes all frames; calls progress() after each part of the stream that completes a frame
async function unpack(run, text, progress) {
    const stream = new Blob([fromBase64(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
    const reader = stream.getReader();
    const known = new Set();
    let buffer = null;
    let filled = 0;
    for (;;) {
        const { done, value } = await reader.read();
        if (done) break;
        const ready = run.ready;
        for (let at = 0; at < value.length && run.ready < run.frames.length; ) {
            const frame = run.frames[run.ready];
            buffer ??= new Uint8Array(frameSize(run, frame, known));
            const count = Math.min(buffer.length - filled, value.length - at);
            buffer.set(value.subarray(at, at + count), filled);
            at += count;
            filled += count;
            if (filled < buffer.length) continue;
            decodeFrame(run, run.ready, buffer);
            known.add(frame.topology);
            buffer = null;
            filled = 0;
        }
        if (run.ready > ready) progress();
    }
    if (run.ready < run.frames.length) throw new Error(`${run.name}: the report contains only ${run.ready} of ${run.frames.length} frames. Write the report again with: pellicle report DIR`);
}

function parseRow(line) {
    if (!line.includes('"')) return line.split(",");
    return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map((m) => m[1]?.replaceAll('""', '"') ?? m[2]);
}

// converts CSV text to { names, columns }
export function parseTable(text) {
    const lines = text.split(/\r?\n/).filter((line) => line !== "");
    if (lines.length === 0) return { names: [], columns: [] };
    const names = parseRow(lines[0]);
    const columns = names.map(() => new Float64Array(lines.length - 1));
    for (let row = 1; row < lines.length; row++) {
        const cells = parseRow(lines[row]);
        for (let c = 0; c < names.length; c++) columns[c][row - 1] = cells[c] === "" ? NaN : Number(cells[c]);
    }
    return { names, columns };
}

function parseSummary(text) {
    try {
        return JSON.parse(text);
    } catch {
        return {};
    }
}

// if the times of the frames do not increase, uses the numbers of the frames instead
function settleTimes(run) {
    run.timed = run.frames.every((frame, i) => i === 0 || frame.time > run.frames[i - 1].time);
    if (!run.timed) run.frames.forEach((frame) => (frame.time = frame.number));
}

function prepare(element, index) {
    const run = JSON.parse(element.textContent);
    run.index = index;
    run.name = run.name.replace(/\/+$/, "").split("/").pop();
    run.sceneTitle = /^title:\s*"?(.*?)"?\s*$/m.exec(run.scene)?.[1] ?? "";
    run.stateHash = /state_hash: (\S+)/.exec(run.scene)?.[1] ?? "";
    run.frames = run.frames.map(([number, time, topology]) => ({ number, time, topology, numbers: null }));
    run.corners = run.topologies.map(() => null);
    run.table = parseTable(run.series);
    run.series = null;
    run.facts = parseSummary(run.summary);
    run.channelBits = [16, 16, 16];
    let channel = 3;
    for (const field of run.fields) {
        field.first = channel;
        channel += field.channels;
        for (let i = 0; i < field.channels; i++) run.channelBits.push(field.bits);
    }
    run.ready = 0;
    settleTimes(run);
    return run;
}

// returns { runs, finished }: the first run.ready frames of a run can be read; `finished` resolves when all frames are decoded
export function readRuns(progress) {
    const heads = [...document.querySelectorAll("script.run")];
    const bodies = [...document.querySelectorAll("script.run-frames")];
    const runs = heads.map(prepare);
    const finished = Promise.all(
        runs.map((run, i) => {
            const text = bodies[i].textContent.trim();
            bodies[i].remove();
            heads[i].remove();
            return unpack(run, text, progress);
        }),
    );
    return { runs, finished };
}

// { index, weight }: the last frame at or before the time, and the position of the time between it and the next frame (0 .. 1)
export function locate(run, time) {
    let low = 0;
    let high = run.ready - 1;
    const margin = 1e-9 * Math.max(1, Math.abs(time));
    while (low < high) {
        const middle = (low + high + 1) >> 1;
        if (run.frames[middle].time <= time + margin) low = middle;
        else high = middle - 1;
    }
    const next = run.frames[low + 1];
    if (!next || low + 1 >= run.ready) return { index: low, weight: 0 };
    const weight = (time - run.frames[low].time) / (next.time - run.frames[low].time);
    return { index: low, weight: weight < 1e-6 ? 0 : Math.min(weight, 1) };
}

// calls emit(v, number) with the numbers of a channel, interpolated between two frames
function blend(run, index, weight, channel, emit) {
    const frame = run.frames[index];
    const count = run.topologies[frame.topology][0];
    const a = frame.numbers;
    const next = run.frames[index + 1];
    const b = weight > 0 && next?.topology === frame.topology ? next.numbers : a;
    const begin = channel * count;
    for (let v = 0; v < count; v++) emit(v, a[begin + v] + weight * (b[begin + v] - a[begin + v]));
}

// fills positions (3 numbers per vertex) [m]
export function fillPositions(run, index, weight, positions) {
    for (let c = 0; c < 3; c++) {
        const low = run.low[c];
        const scale = (run.high[c] - low) / 65535;
        blend(run, index, weight, c, (v, number) => (positions[3 * v + c] = low + scale * number));
    }
}

// fills the values of a field: scalars, or magnitudes of vectors
export function fillValues(run, field, index, weight, values) {
    const [low, high] = field.range;
    const scale = (high - low) / (field.bits === 16 ? 65535 : 255);
    if (field.channels === 1) {
        blend(run, index, weight, field.first, (v, number) => (values[v] = low + scale * number));
        return;
    }
    values.fill(0);
    for (let c = 0; c < field.channels; c++)
        blend(run, index, weight, field.first + c, (v, number) => (values[v] += (low + scale * number) ** 2));
    for (let v = 0; v < values.length; v++) values[v] = Math.sqrt(values[v]);
}

// the components of a field at a vertex; a thinned report may contain only the magnitude
export function componentsAt(run, field, index, v) {
    const frame = run.frames[index];
    const count = run.topologies[frame.topology][0];
    const [low, high] = field.range;
    const scale = (high - low) / (field.bits === 16 ? 65535 : 255);
    return Array.from({ length: field.channels }, (_, c) => low + scale * frame.numbers[(field.first + c) * count + v]);
}

export function positionAt(run, index, v) {
    const frame = run.frames[index];
    const count = run.topologies[frame.topology][0];
    return [0, 1, 2].map((c) => run.low[c] + ((run.high[c] - run.low[c]) / 65535) * frame.numbers[c * count + v]);
}
