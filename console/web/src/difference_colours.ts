// Colours of the map of two bones' difference.

export const NO_DIFFERENCE = 64; // value of a vertex at which the two bones do not differ
export const SAME = 0xb9bec4, SECOND_DEEPER = 0xf06a24, FIRST_DEEPER = 0x2f7df0;

/** The colours as a background of CSS, from the first's end to the second's. */
export const SCALE_BACKGROUND = `linear-gradient(to right, ${[FIRST_DEEPER, SAME, SECOND_DEEPER].map((c) => `#${c.toString(16).padStart(6, "0")}`).join()})`;
