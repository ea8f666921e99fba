// What the hand on a gamepad or a SpaceMouse asks for. Browsers show both through the Gamepad interface (W3C).

// of an axis: less is a stick at rest
const dead = 0.12;
const trim = (value) => (Math.abs(value) < dead ? 0 : (value - Math.sign(value) * dead) / (1 - dead));

// axes of a cap that is pushed, tilted and turned: right, towards the user, down, then turns about these
const isCap = (pad) => pad.mapping !== "standard" && pad.axes.length === 6;

// aim: of the pointer, right and down; turn: of the view, right and up; zoom: nearer; squeeze: 0 to 1; buttons by name
export function readPad(pad) {
    const axes = pad.axes.map(trim);
    const held = (i) => pad.buttons[i]?.value ?? 0;
    if (isCap(pad))
        return {
            aim: [axes[0], axes[1]],
            turn: [axes[5], -axes[3]],
            zoom: 0,
            squeeze: Math.max(0, axes[2]),
            buttons: { undo: held(0) > 0.5, view: held(1) > 0.5 },
        };
    return {
        aim: [axes[0] ?? 0, axes[1] ?? 0],
        turn: [axes[2] ?? 0, -(axes[3] ?? 0)],
        zoom: held(12) - held(13),
        squeeze: Math.max(held(7), held(0)),
        buttons: { undo: held(1) > 0.5, before: held(4) > 0.5, next: held(5) > 0.5, view: held(8) > 0.5, play: held(9) > 0.5 },
    };
}

// the first one that is there; null = none
export const findPad = () => [...(navigator.getGamepads?.() ?? [])].find((pad) => pad?.connected) ?? null;
