// SPDX-License-Identifier: Apache-2.0
#include <segue/web/browser_session.hpp>

#include <segue/base/text.hpp>
#include <segue/type/json.hpp>
#include <segue/web/change.hpp>

#include <utility>

namespace segue::web {

namespace {

using type::Value;

Value error_value(const Error& error) {
  return Value::map({{"code", to_string(error.code)}, {"message", to_string(error)}});
}

Value greeting_of(const Session::Identity& identity) {
  Value greeting = Value::map({{"role", to_string(identity.role)}, {"robot", identity.robot}});
  if (identity.ros2) greeting.as_map().set("ros2", true);
  return greeting;
}

}  // namespace

std::shared_ptr<Session> Session::create(Hub& hub, Verbs& verbs, Identity identity,
                                         std::function<void()> ready) {
  return std::shared_ptr<Session>(new Session(hub, verbs, std::move(identity), std::move(ready)));
}

Session::Session(Hub& hub, Verbs& verbs, Identity identity, std::function<void()> ready)
    : hub_(hub), verbs_(verbs), identity_(std::move(identity)), ready_(std::move(ready)) {
  answers_.push_back(type::to_json(greeting_of(identity_), -1));
}

Session::~Session() {
  hub_.leave(*this);
}

void Session::receive(std::string_view text) {
  auto command = Command::parse(text);
  if (command) return execute(std::move(*command));
  {
    const Lock lock(mutex_);
    answers_.push_back(
        type::to_json(Value::map({{"id", Value()}, {"error", error_value(command.error())}}), -1));
  }
  ready_();
}

void Session::execute(Command command) {
  const std::uint64_t id = command.id();
  {
    const Lock lock(mutex_);
    ++in_progress_;
  }
  if (command.verb() == "subscribe" || command.verb() == "unsubscribe") return answer(id, subscribe(command));
  verbs_.begin(std::move(command), identity_.role, identity_.who,
               [weak = weak_from_this(), id](const Result<Value>& result) {
                 if (const auto self = weak.lock()) self->answer(id, result);
               });
}

Result<Value> Session::subscribe(const Command& command) {
  const auto name = command.text("document");
  if (!name) return name.error();
  if (auto known = command.only({"document"}); !known) return known.error();
  const bool away = command.verb() == "unsubscribe";
  {
    const Lock lock(mutex_);
    if (away) {
      sent_.erase(*name);
      changed_.erase(*name);
    } else if (!sent_.contains(*name) && sent_.size() >= kMostDocuments) {
      return fail(ErrorCode::ResourceExhausted, "a browser looks at 64 documents at most");
    }
  }
  if (away) {
    hub_.unsubscribe(*this, *name);
    return Value();
  }
  if (auto done = hub_.subscribe(shared_from_this(), *name); !done) return done.error();
  const Lock lock(mutex_);
  sent_.emplace(*name, nullptr);
  changed_.insert(*name);
  return Value();
}

void Session::answer(std::uint64_t id, const Result<Value>& result) {
  std::string text =
      result ? type::to_json(Value::map({{"id", id}, {"result", *result}}), -1)
             : type::to_json(Value::map({{"id", id}, {"error", error_value(result.error())}}), -1);
  if (text.size() > kLongestAnswer) {
    const Error error =
        fail(ErrorCode::ResourceExhausted, "the answer is too long: " + format_size(text.size()));
    text = type::to_json(Value::map({{"id", id}, {"error", error_value(error)}}), -1);
  }
  {
    const Lock lock(mutex_);
    if (!result && result.error().code == ErrorCode::PermissionDenied)
      refusals_.tell("a request of " + identity_.who, result.error().message);
    --in_progress_;
    answers_.push_back(std::move(text));
  }
  ready_();
}

void Session::on_change(const std::string& document) {
  {
    const Lock lock(mutex_);
    if (!sent_.contains(document)) return;
    changed_.insert(document);
  }
  ready_();
}

bool Session::is_full() const {
  const Lock lock(mutex_);
  return answers_.size() + in_progress_ >= kMostAnswers;
}

std::optional<std::string> Session::next() {
  std::string name;
  {
    const Lock lock(mutex_);
    if (!answers_.empty()) {
      std::string text = std::move(answers_.front());
      answers_.pop_front();
      return text;
    }
    if (changed_.empty()) return std::nullopt;
    auto chosen = changed_.upper_bound(last_update_);
    if (chosen == changed_.end()) chosen = changed_.begin();
    name = *chosen;
    changed_.erase(chosen);
    last_update_ = name;
  }
  const auto newest = hub_.newest(name);  // without the mutex: the hub has one of its own
  std::string text = newest ? update(name, newest) : std::string();
  return text.empty() ? next() : std::optional(std::move(text));
}

/// Empty where the browser has that version.
std::string Session::update(const std::string& name, const std::shared_ptr<const Document>& newest) {
  std::shared_ptr<const Document> before;
  {
    const Lock lock(mutex_);
    const auto known = sent_.find(name);
    if (known == sent_.end() || (known->second && known->second->version >= newest->version)) return {};
    before = std::exchange(known->second, newest);
  }
  const std::uint64_t skipped = before ? newest->version - before->version - 1 : 0;
  std::string text = "{\"document\":" + type::to_json(Value(name), -1) +
                     ",\"version\":" + std::to_string(newest->version) +
                     ",\"skipped\":" + std::to_string(skipped);
  if (!newest->error.empty()) text += ",\"error\":" + type::to_json(Value(newest->error), -1);
  if (before && before->value.is_map() && newest->value.is_map()) {
    const bool next_version = skipped == 0 && !newest->change.empty();
    text += ",\"change\":" +
            (next_version ? newest->change : type::to_json(change_between(before->value, newest->value), -1));
  } else {
    text += ",\"value\":" + type::to_json(newest->value, -1);
  }
  return text + "}";
}

}  // namespace segue::web
