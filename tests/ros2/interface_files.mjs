// SPDX-License-Identifier: Apache-2.0
//
// The messages of interfaces as texts in the syntax of .msg files, found without Segue: those of .interfaces files, with the messages
// that ROS 2 makes of services and actions (REP-2012, REP-2016).
import fs from "node:fs";
import path from "node:path";

const serviceOf = (name, request, response) => ({
  [`${name}_Request`]: request,
  [`${name}_Response`]: response,
  [`${name}_Event`]: `service_msgs/ServiceEventInfo info\n${name}_Request[<=1] request\n${name}_Response[<=1] response`,
});

const actionOf = (name, goal, result, feedback) => ({
  [`${name}_Goal`]: goal,
  [`${name}_Result`]: result,
  [`${name}_Feedback`]: feedback,
  [`${name}_FeedbackMessage`]: `unique_identifier_msgs/UUID goal_id\n${name}_Feedback feedback`,
  ...serviceOf(`${name}_SendGoal`, `unique_identifier_msgs/UUID goal_id\n${name}_Goal goal`, "bool accepted\nbuiltin_interfaces/Time stamp"),
  ...serviceOf(`${name}_GetResult`, "unique_identifier_msgs/UUID goal_id", `int8 status\n${name}_Result result`),
});

const messagesOf = (kind, name, text) => {
  const sections = text.split(/^---$/m);
  return { msg: () => ({ [name]: text }), srv: () => serviceOf(name, ...sections), action: () => actionOf(name, ...sections) }[kind]();
};

/** All messages of the .interfaces files in a folder: [{package, kind, name, text}]. */
export function builtInMessages(folder) {
  const all = [];
  for (const file of fs.readdirSync(folder).filter((file) => file.endsWith(".interfaces"))) {
    const whole = fs.readFileSync(path.join(folder, file), "utf8");
    for (const part of whole.split(/^=== /m).slice(1)) {
      const [head] = part.split("\n", 1);
      const [kind, interfaceName] = head.split("/");
      for (const [name, text] of Object.entries(messagesOf(kind, interfaceName, part.slice(head.length + 1))))
        all.push({ package: path.basename(file, ".interfaces"), kind, name, text });
    }
  }
  return all;
}
