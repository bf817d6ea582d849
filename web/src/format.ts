/** Numbers as people read them. */

export function isNumber(value: unknown): value is number {
  return typeof value === "number" && Number.isFinite(value);
}

/** Fixed digits for sizes of everyday, powers of ten beyond. */
export function figure(value: unknown, digits = 2): string {
  if (!isNumber(value)) return "–";
  const size = Math.abs(value);
  if (size >= 1e5) return value.toExponential(1);
  return value.toFixed(size >= 1000 ? 0 : size >= 100 ? Math.min(digits, 1) : digits).replace(/^-(0(\.0*)?)$/, "$1");
}

/** "12.3 N", "–" where there is nothing. */
export function quantity(value: unknown, unit: string, digits = 2): string {
  if (!isNumber(value)) return "–";
  const gap = unit === "" || unit === "°" || unit === "%" ? (unit === "%" ? " " : "") : " ";
  return figure(value, digits) + gap + unit;
}

export const degrees = (radians: number): number => (radians * 180) / Math.PI;

/** snake_case of a file as words. */
export const words = (name: string): string => name.replace(/_/g, " ");
