// What the program itself says: rows of its CSV and the face colours of its PLY.
import { readFile } from "node:fs/promises";

// One object per face: column name to text.
export async function rows(file) {
  const [head, ...lines] = (await readFile(file, "utf8")).trim().split("\n").map((line) => line.split(","));
  return lines.map((fields) => Object.fromEntries(head.map((name, i) => [name, fields[i]])));
}

// Red, green and blue of every face of an annotated PLY.
export async function colors(file) {
  const data = await readFile(file);
  const end = data.indexOf("end_header\n") + 11;
  const sizes = { char: 1, uchar: 1, float: 4, double: 8 };
  let [where, vertices, faces, stride, row, red] = ["", 0, 0, 0, 0, 0];
  for (const line of data.subarray(0, end).toString().split("\n")) {
    const word = line.split(" ");
    if (word[0] === "element") {
      where = word[1];
      if (where === "vertex") vertices = Number(word[2]);
      else faces = Number(word[2]);
    } else if (word[0] === "property" && where === "vertex") stride += sizes[word[1]];
    else if (word[0] === "property") {
      if (word[2] === "red") red = row;
      row += word[1] === "list" ? 13 : sizes[word[1]];
    }
  }
  const start = end + vertices * stride;
  return Array.from({ length: faces }, (_, f) => [...data.subarray(start + f * row + red, start + f * row + red + 3)]);
}
