// node read.mjs FILE.mcap FOLDER: whether @mcap/core finds the folder's images (cam0/STAMP.png) and
// samples (imu0.csv) in the file, byte for byte and bit for bit. Says how many; fails otherwise.

import {McapStreamReader} from "@mcap/core";
import {deepStrictEqual} from "node:assert/strict";
import {readdirSync, readFileSync} from "node:fs";
import {join} from "node:path";

const [file, folder] = process.argv.slice(2);

class Cdr {
  #data;
  #at = 0;

  constructor(message) {
    this.#data = Buffer.from(message).subarray(4);
  }
  #align(size) {
    this.#at += (size - this.#at % size) % size;
  }
  uint32() {
    this.#align(4);
    this.#at += 4;
    return this.#data.readUInt32LE(this.#at - 4);
  }
  double() {
    this.#align(8);
    this.#at += 8;
    return this.#data.readDoubleLE(this.#at - 8);
  }
  doubles(count) {
    return Array.from({length: count}, () => this.double());
  }
  octets() {
    const size = this.uint32();
    this.#at += size;
    return this.#data.subarray(this.#at - size, this.#at);
  }
  stamp() {
    return BigInt(this.uint32()) * 1_000_000_000n + BigInt(this.uint32());
  }
}

const images = new Map();
const samples = [];
const channels = new Map();
const schemas = new Map();
const reader = new McapStreamReader();
reader.append(readFileSync(file));
for (let record; (record = reader.nextRecord());) {
  if (record.type === "Schema") schemas.set(record.id, record);
  if (record.type === "Channel") channels.set(record.id, record);
  if (record.type !== "Message") continue;
  const schema = schemas.get(channels.get(record.channelId).schemaId);
  const message = new Cdr(record.data);
  const stamp = message.stamp();
  deepStrictEqual(record.logTime, stamp);
  message.octets();  // frame_id
  if (schema.name === "sensor_msgs/msg/CompressedImage") {
    message.octets();  // format
    images.set(`${stamp}.png`, Buffer.from(message.octets()));
  } else {
    deepStrictEqual(schema.name, "sensor_msgs/msg/Imu");
    message.doubles(13);
    const rates = message.doubles(3);
    message.doubles(9);
    samples.push([stamp, ...rates, ...message.doubles(3)]);
  }
}
if (!reader.done()) throw new Error("the file ends too early");

const names = readdirSync(join(folder, "cam0"));
deepStrictEqual([...images.keys()].sort(), names.sort());
for (const name of names) {
  deepStrictEqual(images.get(name), readFileSync(join(folder, "cam0", name)));
}
const lines = readFileSync(join(folder, "imu0.csv"), "utf8").trim().split("\n").slice(1);
deepStrictEqual(samples, lines.map((line) => {
  const fields = line.split(",");
  return [BigInt(fields[0]), ...fields.slice(1).map(Number)];
}));
console.log(`${images.size} images, ${samples.length} samples`);
