// node write.mjs FOLDER OUT.mcap: a recording (cam0/STAMP.png, imu0.csv) as ROS 2 messages, by
// @mcap/core.

import {McapWriter} from "@mcap/core";
import {appendFileSync, readdirSync, readFileSync, writeFileSync} from "node:fs";
import {join} from "node:path";

const [folder, out] = process.argv.slice(2);

/** CDR, little-endian: every number at a multiple of its size, counted from behind the head. */
class Cdr {
  #bytes = [Buffer.from([0, 1, 0, 0])];
  #size = 0;

  #add(buffer) {
    this.#bytes.push(buffer);
    this.#size += buffer.length;
  }
  #align(size) {
    this.#add(Buffer.alloc((size - this.#size % size) % size));
  }
  uint32(value) {
    this.#align(4);
    const buffer = Buffer.alloc(4);
    buffer.writeUInt32LE(value);
    this.#add(buffer);
    return this;
  }
  double(value) {
    this.#align(8);
    const buffer = Buffer.alloc(8);
    buffer.writeDoubleLE(value);
    this.#add(buffer);
    return this;
  }
  string(text) {
    const buffer = Buffer.from(`${text}\0`);
    this.uint32(buffer.length).#add(buffer);
    return this;
  }
  octets(buffer) {
    this.uint32(buffer.length).#add(buffer);
    return this;
  }
  header(stamp) {
    return this.uint32(Number(stamp / 1_000_000_000n)).uint32(Number(stamp % 1_000_000_000n))
        .string("rig");
  }
  bytes() {
    return Buffer.concat(this.#bytes);
  }
}

const messages = [];
for (const name of readdirSync(join(folder, "cam0"))) {
  const stamp = BigInt(name.replace(/\.png$/, ""));
  const data = new Cdr().header(stamp).string("png").octets(readFileSync(join(folder, "cam0", name)));
  messages.push({topic: "camera", stamp, data: data.bytes()});
}
for (const line of readFileSync(join(folder, "imu0.csv"), "utf8").trim().split("\n").slice(1)) {
  const fields = line.split(",");
  const stamp = BigInt(fields[0]);
  const data = new Cdr().header(stamp);
  for (const x of [0, 0, 0, 1]) data.double(x);
  for (let k = 0; k < 9; ++k) data.double(0);
  for (const x of fields.slice(1, 4)) data.double(Number(x));
  for (let k = 0; k < 9; ++k) data.double(0);
  for (const x of fields.slice(4, 7)) data.double(Number(x));
  for (let k = 0; k < 9; ++k) data.double(0);
  messages.push({topic: "imu", stamp, data: data.bytes()});
}
messages.sort((a, b) => a.stamp < b.stamp ? -1 : a.stamp > b.stamp ? 1 : 0);

writeFileSync(out, "");
let position = 0n;
const writer = new McapWriter({
  chunkSize: 200_000,
  writable: {
    async write(buffer) {
      appendFileSync(out, buffer);
      position += BigInt(buffer.length);
    },
    position: () => position,
  },
});
await writer.start({profile: "ros2", library: "test"});
const channels = {};
for (const [key, topic, type] of [
  ["camera", "/cam0/image_raw/compressed", "sensor_msgs/msg/CompressedImage"],
  ["imu", "/imu0", "sensor_msgs/msg/Imu"],
]) {
  const schemaId =
      await writer.registerSchema({name: type, encoding: "ros2msg", data: new Uint8Array()});
  channels[key] = await writer.registerChannel(
      {schemaId, topic, messageEncoding: "cdr", metadata: new Map()});
}
for (const [sequence, message] of messages.entries()) {
  await writer.addMessage({
    channelId: channels[message.topic], sequence, logTime: message.stamp,
    publishTime: message.stamp, data: message.data,
  });
}
await writer.end();
