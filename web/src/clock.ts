/** The one time cursor of a page: replay, plots and phase bar all follow it. */

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4, 8];

export class Clock {
  time: number;
  playing = false;
  speed = 1;
  private readonly listeners: (() => void)[] = [];
  private before = 0;

  constructor(
    public start: number,
    public end: number,
  ) {
    this.time = end;
  }

  /** Called once per picture at most, whenever time, state or range changed. */
  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  set(time: number): void {
    this.time = Math.min(this.end, Math.max(this.start, time));
    this.tell();
  }

  setRange(start: number, end: number): void {
    this.start = start;
    this.end = end;
    this.set(this.time);
  }

  toggle(): void {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.time >= this.end) this.time = this.start;
      this.before = performance.now();
      requestAnimationFrame((now) => this.step(now));
    }
    this.tell();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.tell();
  }

  private step(now: number): void {
    if (!this.playing) return;
    const passed = Math.max(0, now - this.before) / 1000;
    this.before = now;
    this.time = Math.min(this.end, this.time + passed * this.speed);
    if (this.time >= this.end) this.playing = false;
    this.notify();
    if (this.playing) requestAnimationFrame((next) => this.step(next));
  }

  private queued = false;
  private tell(): void {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.notify();
    });
  }

  private notify(): void {
    for (const listener of this.listeners) listener();
  }
}
