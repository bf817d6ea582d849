/** Reads what pack.cpp wrote: 32-bit floats column by column, bytes apart, deflated, base64. */

async function inflate(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array> {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

export async function unpackColumns(text: string, columns: number, rows: number): Promise<Float32Array[]> {
  const bytes = await inflate(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
  if (bytes.length !== 4 * columns * rows) throw new Error("the data of this page are incomplete");
  const out: Float32Array[] = [];
  for (let column = 0; column < columns; ++column) {
    const values = new Float32Array(rows);
    const target = new Uint8Array(values.buffer);
    const begin = 4 * rows * column;
    for (let k = 0; k < 4; ++k) {
      for (let i = 0; i < rows; ++i) target[4 * i + k] = bytes[begin + k * rows + i];
    }
    out.push(values);
  }
  return out;
}
