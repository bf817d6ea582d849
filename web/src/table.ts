/** A table of many rows of which only those in sight exist as elements. */
import type { Campaign } from "./campaign";
import { button, el } from "./dom";
import { degrees, figure } from "./format";

export interface Column {
  name: string;
  label: string;
  width: number;
  digits?: number;
  /** Shown in degrees although the file has radians. */
  angle?: boolean;
  share?: boolean;
}

const ROW = 30; // [px]
const SPARE = 8;

export class Table {
  readonly element: HTMLElement;
  private readonly head = el("div", { class: "row head", role: "row" });
  private readonly body = el("div", { class: "rows", role: "rowgroup" });
  private readonly scroll = el("div", { class: "scroll", tabindex: "0", role: "table", "aria-label": "Runs" });
  private rows: number[] = [];
  private order = { column: "run", rising: true };
  private selected = -1;

  constructor(
    private readonly campaign: Campaign,
    private readonly columns: Column[],
    private readonly select: (row: number) => void,
  ) {
    const width = columns.reduce((sum, c) => sum + c.width, 0);
    this.head.style.width = this.body.style.width = `${width}px`;
    this.scroll.append(this.head, this.body);
    this.scroll.addEventListener("scroll", () => this.draw());
    this.element = this.scroll;
    new ResizeObserver(() => this.draw()).observe(this.scroll);
    this.drawHead();
  }

  show(rows: number[]): void {
    this.rows = rows;
    this.sort();
    this.scroll.scrollTop = 0;
    this.draw();
  }

  private drawHead(): void {
    this.head.replaceChildren(
      ...this.columns.map((column) => {
        const sorted = this.order.column === column.name;
        const mark = sorted ? (this.order.rising ? " ▲" : " ▼") : "";
        const cell = el("div", { role: "columnheader", style: `width:${column.width}px`, title: column.name });
        cell.setAttribute("aria-sort", sorted ? (this.order.rising ? "ascending" : "descending") : "none");
        cell.append(button(column.label + mark, () => this.sortBy(column.name)));
        return cell;
      }),
    );
  }

  private sortBy(column: string): void {
    this.order = { column, rising: this.order.column === column ? !this.order.rising : true };
    this.drawHead();
    this.sort();
    this.draw();
  }

  /** Missing values stand last whichever way one sorts. */
  private sort(): void {
    const { column, rising } = this.order;
    const sign = rising ? 1 : -1;
    const c = this.campaign;
    if (c.isNumber(column)) {
      this.rows.sort((a, b) => {
        const x = c.number(column, a);
        const y = c.number(column, b);
        if (Number.isNaN(x) || Number.isNaN(y)) return Number(Number.isNaN(x)) - Number(Number.isNaN(y)) || a - b;
        return sign * (x - y) || a - b;
      });
    } else {
      this.rows.sort((a, b) => sign * c.text(column, a).localeCompare(c.text(column, b)) || a - b);
    }
  }

  private cell(column: Column, row: number): HTMLElement {
    const text = this.words(column, row);
    const cell = el("div", { role: "cell", style: `width:${column.width}px`, title: text }, text);
    if (this.campaign.isNumber(column.name)) cell.classList.add("number");
    if (column.name === "outcome") cell.classList.add(this.campaign.opened(row) ? "yes" : "no");
    return cell;
  }

  private words(column: Column, row: number): string {
    if (!this.campaign.isNumber(column.name)) return this.campaign.text(column.name, row).replace(/_/g, " ");
    const value = this.campaign.number(column.name, row);
    return figure(column.angle ? degrees(value) : column.share ? 100 * value : value, column.digits ?? 2);
  }

  private draw(): void {
    this.body.style.height = `${this.rows.length * ROW}px`;
    this.scroll.setAttribute("aria-rowcount", String(this.rows.length + 1));
    const first = Math.max(0, Math.floor(this.scroll.scrollTop / ROW) - SPARE);
    const last = Math.min(this.rows.length, Math.ceil((this.scroll.scrollTop + this.scroll.clientHeight) / ROW) + SPARE);
    const made: HTMLElement[] = [];
    for (let i = first; i < last; ++i) made.push(this.line(i));
    this.body.replaceChildren(...made);
  }

  private line(i: number): HTMLElement {
    const row = this.rows[i];
    const line = el("div", { class: "row", role: "row", style: `top:${i * ROW}px`, "aria-rowindex": String(i + 2) });
    if (row === this.selected) line.classList.add("selected");
    for (const [k, column] of this.columns.entries()) {
      const cell = this.cell(column, row);
      if (k === 0) {
        const open = button(cell.textContent ?? "", () => undefined, { class: "link" });
        open.setAttribute("aria-label", `Run ${cell.textContent}: why it ended, replay`);
        cell.replaceChildren(open);
      }
      line.append(cell);
    }
    line.addEventListener("click", () => {
      this.selected = row;
      this.select(row);
      this.draw();
    });
    return line;
  }
}
