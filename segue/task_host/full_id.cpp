// SPDX-License-Identifier: Apache-2.0
#include <segue/task_host/full_id.hpp>

#include <string>

namespace segue::task_host {

model::TaskId full_id(const model::TaskId& task, const model::DeploymentKey& process) {
  return model::TaskId(task.str() + '@' + process.host.str() + '/' + process.process.str());
}

SplitId split_id(const model::TaskId& id) {
  const std::string& text = id.str();
  const std::size_t at = text.find('@');
  const std::size_t slash = at == std::string::npos ? at : text.find('/', at);
  if (slash == std::string::npos) {
    return {id, std::nullopt};
  }
  return {model::TaskId(text.substr(0, at)),
          model::DeploymentKey{model::HostName(text.substr(at + 1, slash - at - 1)),
                               model::ProcessName(text.substr(slash + 1))}};
}

model::TaskId plain_id(const model::TaskId& id) {
  return split_id(id).task;
}

}  // namespace segue::task_host
