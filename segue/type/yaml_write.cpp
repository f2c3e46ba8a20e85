// SPDX-License-Identifier: Apache-2.0
#include <segue/type/scalar_text.hpp>
#include <segue/type/yaml.hpp>

#include <yaml.h>

#include <algorithm>
#include <array>
#include <string>

namespace segue::type {
namespace {

constexpr std::size_t kLineWidth = 80;  // a leaf list or map longer than this takes a line per entry
constexpr std::size_t kIndent = 2;
constexpr std::size_t kPunctuation = 2;  // ", "

// Plain text in YAML 1.2, but a boolean to readers that still follow 1.1.
constexpr std::array<std::string_view, 8> kOldBooleans = {"y", "n", "yes", "no", "on", "off", "Y", "N"};

bool is_old_boolean(const std::string& text) {
  std::string lower = text;
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return std::ranges::find(kOldBooleans, lower) != kOldBooleans.end();
}

bool is_leaf(const Value& value) {
  if (value.is_list()) return value.as_list().empty();
  return !value.is_map() || value.as_map().empty();
}

// Prefers the source text of a number, from which a text property takes "1.10". Checked, since anybody can
// set a source text.
std::string plain_text(const Value& value) {
  if (const auto source = value.source_text(); !source.empty()) {
    const Value again = detail::resolve_plain(source);
    if (again.kind() == value.kind() && again == value) return std::string(source);
  }
  return detail::print_scalar(value);
}

std::size_t leaf_width(const Value& value) {
  if (value.is_string()) return value.as_string().size();
  return value.is_list() || value.is_map() ? 2 : plain_text(value).size();
}

bool fits_on_a_line(const Value& value, std::size_t room) {
  std::size_t width = 2;  // brackets
  auto takes = [&](std::size_t key, const Value& item) {
    if (!is_leaf(item) || (item.is_string() && item.as_string().find('\n') != std::string::npos))
      return false;
    width += key + leaf_width(item) + kPunctuation;
    return width <= room;
  };
  if (value.is_list()) {
    return std::ranges::all_of(value.as_list(), [&](const Value& item) { return takes(0, item); });
  }
  return std::ranges::all_of(value.as_map(), [&](const ValueMap::Entry& entry) {
    return takes(entry.first.size() + kPunctuation, entry.second);
  });
}

class YamlWriter {
 public:
  YamlWriter() {
    yaml_emitter_initialize(&emitter_);
    yaml_emitter_set_output(&emitter_, append, &text_);
    yaml_emitter_set_unicode(&emitter_, 1);
    yaml_emitter_set_width(&emitter_, -1);
    yaml_emitter_set_indent(&emitter_, static_cast<int>(kIndent));
  }
  YamlWriter(const YamlWriter&) = delete;
  YamlWriter& operator=(const YamlWriter&) = delete;
  ~YamlWriter() { yaml_emitter_delete(&emitter_); }

  std::string write(const Value& value) {
    yaml_event_t event;
    yaml_stream_start_event_initialize(&event, YAML_UTF8_ENCODING);
    emit(event);
    yaml_document_start_event_initialize(&event, nullptr, nullptr, nullptr, 1);
    emit(event);
    node(value, 0, 0);
    yaml_document_end_event_initialize(&event, 1);
    emit(event);
    yaml_stream_end_event_initialize(&event);
    emit(event);
    return std::move(text_);
  }

 private:
  static int append(void* text, unsigned char* buffer, std::size_t size) {
    static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(buffer), size);
    return 1;
  }

  void emit(yaml_event_t& event) { yaml_emitter_emit(&emitter_, &event); }

  // `used`: columns that the key before the value takes.
  void node(const Value& value, std::size_t level, std::size_t used) {
    if (value.is_list() || value.is_map()) {
      const std::size_t taken = level * kIndent + used;
      const bool flow = taken < kLineWidth && fits_on_a_line(value, kLineWidth - taken);
      value.is_list() ? list(value.as_list(), level, flow) : map(value.as_map(), level, flow);
    } else if (value.is_string()) {
      text(value.as_string());
    } else {
      scalar(plain_text(value), YAML_PLAIN_SCALAR_STYLE);
    }
  }

  void list(const Value::List& items, std::size_t level, bool flow) {
    yaml_event_t event;
    yaml_sequence_start_event_initialize(&event, nullptr, nullptr, 1,
                                         flow ? YAML_FLOW_SEQUENCE_STYLE : YAML_BLOCK_SEQUENCE_STYLE);
    emit(event);
    for (const Value& item : items)
      node(item, level + 1, 0);
    yaml_sequence_end_event_initialize(&event);
    emit(event);
  }

  void map(const ValueMap& entries, std::size_t level, bool flow) {
    yaml_event_t event;
    yaml_mapping_start_event_initialize(&event, nullptr, nullptr, 1,
                                        flow ? YAML_FLOW_MAPPING_STYLE : YAML_BLOCK_MAPPING_STYLE);
    emit(event);
    for (const auto& [name, value] : entries) {
      key(name);
      node(value, level + 1, name.size() + kPunctuation);
    }
    yaml_mapping_end_event_initialize(&event);
    emit(event);
  }

  // Our reader takes any plain scalar as the key it spells; quotes where that has a meaning of its own to
  // others.
  void key(const std::string& name) {
    const Value plain = detail::resolve_plain(name);
    const bool special = name == "<<" || plain.is_null() || plain.is_bool() || is_old_boolean(name);
    scalar(detail::valid_utf8(name), special ? YAML_SINGLE_QUOTED_SCALAR_STYLE : YAML_PLAIN_SCALAR_STYLE);
  }

  void text(const std::string& content) {
    const std::string valid = detail::valid_utf8(content);
    // A lone "<<" is text here, too, but 1.1 readers stumble.
    const bool special = valid == "<<" || is_old_boolean(valid) || !detail::resolve_plain(valid).is_string();
    const bool lines = valid.find('\n') != std::string::npos;
    scalar(valid, special ? YAML_SINGLE_QUOTED_SCALAR_STYLE
                  : lines ? YAML_LITERAL_SCALAR_STYLE
                          : YAML_PLAIN_SCALAR_STYLE);
  }

  // libyaml chooses another style by itself where this one cannot carry the text.
  void scalar(const std::string& content, yaml_scalar_style_t style) {
    yaml_event_t event;
    yaml_scalar_event_initialize(&event, nullptr, nullptr,
                                 reinterpret_cast<const yaml_char_t*>(content.data()),
                                 static_cast<int>(content.size()), 1, 1, style);
    emit(event);
  }

  yaml_emitter_t emitter_{};
  std::string text_;
};

}  // namespace

std::string to_yaml(const Value& value) {
  return YamlWriter().write(value);
}

}  // namespace segue::type
