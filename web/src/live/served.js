// The page of `pellicle live`: the simulation runs in the program, which serves the page.
import { run } from "./main.js";
import { Wire } from "./wire.js";

run((received, changed) => new Wire(received, changed));
