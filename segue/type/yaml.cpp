// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/text.hpp>
#include <segue/type/collection.hpp>
#include <segue/type/scalar_text.hpp>
#include <segue/type/yaml.hpp>

#include <yaml.h>

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace segue::type {
namespace {

constexpr std::size_t kAliasBudget = 1'000'000;  // nodes copied for anchors and aliases together
constexpr std::size_t kBytesPerNode = 64;        // long texts count as several nodes
constexpr std::string_view kTagPrefix = "tag:yaml.org,2002:";

std::string_view text_of(const yaml_char_t* text) {
  return text == nullptr ? std::string_view() : reinterpret_cast<const char*>(text);
}

Mark mark_of(const yaml_mark_t& mark) {
  return {static_cast<std::uint32_t>(mark.line + 1), static_cast<std::uint32_t>(mark.column + 1)};
}

class Event {
 public:
  Event() = default;
  Event(const Event&) = delete;
  Event& operator=(const Event&) = delete;
  ~Event() { yaml_event_delete(&event_); }
  yaml_event_t* operator->() { return &event_; }
  yaml_event_t* get() { return &event_; }
  [[nodiscard]] Mark mark() const { return mark_of(event_.start_mark); }

 private:
  yaml_event_t event_{};
};

/// A finished value and what copying it would cost.
struct OpenNode {
  Value value;
  std::size_t nodes = 1;
  std::size_t height = 0;  // levels of lists and maps
};

/// A list or map whose end has not been seen.
struct Frame {
  detail::Collection collection;
  std::string anchor;
  std::size_t nodes = 1;
  std::size_t height = 0;

  void add(OpenNode node) {
    nodes += node.nodes;
    height = std::max(height, node.height);
    collection.add(std::move(node.value));
  }
  OpenNode finish() { return {collection.finish(), nodes, height + 1}; }
};

class YamlReader {
 public:
  /// An empty view may point nowhere, which the parser does not take.
  YamlReader(std::string_view text, const std::string& file)
      : text_(text.data() == nullptr ? std::string_view("") : text), file_(file) {
    ready_ = yaml_parser_initialize(&parser_) != 0;
    if (ready_) {
      yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text_.data()),
                                   text_.size());
    }
  }
  YamlReader(const YamlReader&) = delete;
  YamlReader& operator=(const YamlReader&) = delete;
  ~YamlReader() {
    if (ready_) yaml_parser_delete(&parser_);
  }

  Result<Value> read() {
    if (!ready_) return fail(ErrorCode::ResourceExhausted, "no memory to read YAML", {}, {file_, 0, 0});
    for (bool more = true; more;) {
      Event event;
      if (yaml_parser_parse(&parser_, event.get()) == 0) return syntax_error();
      if (auto done = take(event); !done) return done.error();
      more = event->type != YAML_STREAM_END_EVENT;
    }
    return std::move(root_);
  }

 private:
  [[nodiscard]] Error refuse(std::string message, Mark at) const {
    return fail(ErrorCode::ParseError, std::move(message), {},
                {file_, static_cast<int>(at.line), static_cast<int>(at.column)});
  }

  Result<void> take(Event& event) {
    switch (event->type) {
      case YAML_DOCUMENT_START_EVENT:
        if (std::exchange(began_, true)) {
          return refuse("a second document begins here; only one is read: put it into a file of its own",
                        event.mark());
        }
        return {};
      case YAML_SCALAR_EVENT:
        return take_scalar(event);
      case YAML_ALIAS_EVENT:
        return take_alias(event);
      case YAML_SEQUENCE_START_EVENT:
        return open(event, false, event->data.sequence_start.anchor);
      case YAML_MAPPING_START_EVENT:
        return open(event, true, event->data.mapping_start.anchor);
      case YAML_SEQUENCE_END_EVENT:
      case YAML_MAPPING_END_EVENT:
        return close(event);
      default:
        return {};
    }
  }

  [[nodiscard]] bool expects_key() const { return !open_.empty() && open_.back().collection.expects_key(); }

  Result<void> take_scalar(Event& event) {
    const auto& scalar = event->data.scalar;
    std::string text(reinterpret_cast<const char*>(scalar.value), scalar.length);
    const bool plain = scalar.style == YAML_PLAIN_SCALAR_STYLE;
    if (expects_key() && scalar.anchor == nullptr && scalar.tag == nullptr) {
      return take_key(text, plain, event.mark());
    }
    auto value = scalar_value(text, text_of(scalar.tag), plain, event.mark());
    if (!value) return value.error();
    OpenNode node{*std::move(value), 1 + text.size() / kBytesPerNode, 0};
    if (auto kept = keep(std::string(text_of(scalar.anchor)), node, event.mark()); !kept) return kept;
    if (expects_key()) return take_key(text, plain, event.mark());
    add(std::move(node));
    return {};
  }

  // Tags of other languages (!!python/unicode) say nothing about the data: the value is read as if untagged.
  [[nodiscard]] Result<Value> scalar_value(const std::string& text, std::string_view tag, bool plain,
                                           Mark at) const {
    const bool core = tag.starts_with(kTagPrefix) && tag.find('/') == std::string_view::npos;
    auto value = core ? tagged_value(text, tag.substr(kTagPrefix.size()), at)
                      : Result<Value>(plain && tag != "!" ? detail::resolve_plain(text) : Value(text));
    if (value) value->set_mark(at);
    return value;
  }

  [[nodiscard]] Result<Value> tagged_value(const std::string& text, std::string_view type, Mark at) const {
    if (type == "str") return Value(text);
    Value value = detail::resolve_plain(text);
    if (type == "float" && value.is_integer()) return Value(value.as_double());
    const bool fits = (type == "null" && value.is_null()) || (type == "bool" && value.is_bool()) ||
                      (type == "int" && value.is_integer()) || (type == "float" && value.is_number());
    if (fits) return value;
    return refuse(quote(text) + " cannot be read as its tag says (!!" + std::string(type) + ")", at);
  }

  Result<void> take_key(const std::string& key, bool plain, Mark at) {
    if (plain && key == "<<") {
      return refuse("merge keys ('<<') are not supported: write the entries out, or quote the key", at);
    }
    open_.back().nodes += key.size() / kBytesPerNode;
    if (!open_.back().collection.take_key(key)) {
      return refuse("the key " + quote(key) + " occurs twice in this map", at);
    }
    return {};
  }

  Result<void> take_alias(Event& event) {
    const std::string name(text_of(event->data.alias.anchor));
    if (expects_key())
      return refuse("the alias '*" + name + "' cannot be a key: write the key out", event.mark());
    const auto anchor = anchors_.find(name);
    if (anchor == anchors_.end()) {
      return refuse("no value before this place has the anchor " + quote("&" + name), event.mark());
    }
    if (open_.size() + anchor->second.height > kDeepestNesting) return too_deep(event.mark());
    if (auto paid = pay(anchor->second, event.mark()); !paid) return paid;
    add(anchor->second);
    return {};
  }

  Result<void> open(Event& event, bool is_map, const yaml_char_t* anchor) {
    if (expects_key()) {
      return refuse(std::string("a key must be a scalar, not ") + (is_map ? "a map" : "a list") +
                        "; text with braces or brackets needs quotes",
                    event.mark());
    }
    if (open_.size() >= kDeepestNesting) return too_deep(event.mark());
    Frame frame{detail::Collection(is_map, event.mark()), std::string(text_of(anchor))};
    // An anchor of that name from before must not be seen from inside.
    if (!frame.anchor.empty()) anchors_.erase(frame.anchor);
    open_.push_back(std::move(frame));
    return {};
  }

  Result<void> close(Event& event) {
    Frame frame = std::move(open_.back());
    open_.pop_back();
    OpenNode node = frame.finish();
    if (auto kept = keep(std::move(frame.anchor), node, event.mark()); !kept) return kept;
    add(std::move(node));
    return {};
  }

  Result<void> keep(std::string anchor, const OpenNode& node, Mark at) {
    if (anchor.empty()) return {};
    if (auto paid = pay(node, at); !paid) return paid;
    anchors_.insert_or_assign(std::move(anchor), node);
    return {};
  }

  Result<void> pay(const OpenNode& node, Mark at) {
    if (node.nodes > budget_) {
      return refuse("anchors and aliases expand to more than a million values: write less by reference", at);
    }
    budget_ -= node.nodes;
    return {};
  }

  [[nodiscard]] Error too_deep(Mark at) const {
    return refuse("lists and maps are nested deeper than " + std::to_string(kDeepestNesting) + " levels", at);
  }

  void add(OpenNode node) {
    if (open_.empty()) {
      root_ = std::move(node.value);
    } else {
      open_.back().add(std::move(node));
    }
  }

  [[nodiscard]] Error syntax_error() const {
    if (parser_.error == YAML_MEMORY_ERROR) {
      return fail(ErrorCode::ResourceExhausted, "no memory to read YAML", {}, {file_, 0, 0});
    }
    std::string message = parser_.problem == nullptr ? "invalid YAML" : parser_.problem;
    if (parser_.error == YAML_READER_ERROR)
      return refuse(std::move(message), place_of(parser_.problem_offset));
    if (parser_.context != nullptr) {
      message += std::string(" ") + parser_.context;
      if (parser_.context_mark.line != parser_.problem_mark.line) {
        message += " that begins at line " + std::to_string(parser_.context_mark.line + 1);
      }
    }
    if (message.find("cannot start any token") != std::string::npos) {
      message += "; indent with spaces, not tabs, and quote text that begins with '@', '`' or '%'";
    }
    return refuse(std::move(message), mark_of(parser_.problem_mark));
  }

  [[nodiscard]] Mark place_of(std::size_t offset) const {
    const std::string_view before = text_.substr(0, offset);
    const std::size_t begin = before.rfind('\n') + 1;  // npos + 1 is 0: the first line
    return {static_cast<std::uint32_t>(std::ranges::count(before, '\n') + 1),
            static_cast<std::uint32_t>(before.size() - begin + 1)};
  }

  std::string_view text_;
  const std::string& file_;
  yaml_parser_t parser_{};
  bool ready_ = false;
  bool began_ = false;
  Value root_;
  std::vector<Frame> open_;
  std::unordered_map<std::string, OpenNode> anchors_;
  std::size_t budget_ = kAliasBudget;
};

}  // namespace

Result<Value> parse_yaml(std::string_view text, const std::string& file) {
  return YamlReader(text, file).read();
}

Result<Value> load_yaml(const std::filesystem::path& file) {
  auto text = read_input_file(file);
  if (!text) return text.error();
  return parse_yaml(*text, file.string());
}

}  // namespace segue::type
