// @ts-check
/** How many ticks were missed of late: pure. */

/** s */
export const SPAN = 60;

/** By how much a count has grown in the last minute. */
export function growth() {
  let seen = [];
  return {
    add(count, time) {
      if (seen.length && (time < seen[seen.length - 1].time || count < seen[seen.length - 1].count)) seen = []; // another daemon
      seen.push({ count, time });
      while (seen[0].time < time - SPAN) seen.shift();
    },
    get recent() {
      return seen.length ? seen[seen.length - 1].count - seen[0].count : 0;
    },
  };
}
