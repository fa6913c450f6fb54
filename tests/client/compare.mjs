// How far two rows of balls are apart.

/** For each ball: root mean square of a - b over that of b, all channels. */
export function compare(a, b) {
  return Array.from({ length: a.width / a.height }, (_, ball) => {
    let [difference, power] = [0, 0];
    for (let row = 0; row < a.height; ++row)
      for (let column = ball * a.height; column < (ball + 1) * a.height; ++column) {
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
export const within = (balls, allowed) => balls.every((error, ball) => error <= allowed[ball]);
/** A row of docs/notes/clients.md's tables. */
export const tableRow = (name, balls) => `| ${[name, ...balls.map(percent)].join(" | ")} |`;
