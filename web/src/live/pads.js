// Input of gamepads and SpaceMouse devices. Browsers provide both through the Gamepad interface (W3C).

// dead zone of an axis: smaller values count as 0
const dead = 0.12;
const trim = (value) => (Math.abs(value) < dead ? 0 : (value - Math.sign(value) * dead) / (1 - dead));

// a SpaceMouse has six axes: motion of the cap to the right, towards the user and down, then rotations about these directions
const isCap = (pad) => pad.mapping !== "standard" && pad.axes.length === 6;

// aim: motion of the pointer, right and down; turn: rotation of the view, right and up; zoom: positive zooms in; squeeze: 0 to 1;
// buttons: by name, whether they are pressed
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

// the first connected device; null = none
export const findPad = () => [...(navigator.getGamepads?.() ?? [])].find((pad) => pad?.connected) ?? null;
