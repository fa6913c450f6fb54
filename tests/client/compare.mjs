// How far two rows of spheres are apart.

/** For each sphere: root mean square of a - b over that of b, all channels. */
export function compare(a, b) {
  return Array.from({ length: a.width / a.height }, (_, sphere) => {
    let [difference, power] = [0, 0];
    for (let row = 0; row < a.height; ++row)
      for (let column = sphere * a.height; column < (sphere + 1) * a.height; ++column) {
        const at = (row * a.width + column) * 4;
        if (a.light[at + 3] === 0) continue;
        for (let channel = at; channel < at + 3; ++channel) {
          difference += (a.light[channel] - b.light[channel]) ** 2;
          power += b.light[channel] ** 2;
        }
      }
    return Math.sqrt(difference / power);
  });
}

export const percent = (value) => `${(100 * value).toFixed(100 * value < 9.95 ? 2 : 1)} %`;
export const within = (spheres, allowed) => spheres.every((error, sphere) => error <= allowed[sphere]);
/** A row of docs/notes/clients.md's tables. */
export const tableRow = (name, spheres) => `| ${[name, ...spheres.map(percent)].join(" | ")} |`;
