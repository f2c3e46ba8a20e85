// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/type/composite_type.hpp>
#include <segue/type/typelib.hpp>
#include <segue/type/typelib_layout.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <pugixml.hpp>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace segue::type {
namespace {

constexpr int kLongestChain = 64;

/// Converts byte offsets of a text to lines and columns.
class ElementPlaces {
 public:
  ElementPlaces(std::string_view text, const std::string& file) : file_(file) {
    for (std::size_t at = 0; at != std::string_view::npos && at < text.size();) {
      line_starts_.push_back(at);
      at = text.find('\n', at);
      if (at != std::string_view::npos) ++at;
    }
  }

  [[nodiscard]] SourceLocation at(std::ptrdiff_t offset) const {
    if (offset < 0 || line_starts_.empty()) return {file_, 0, 0};
    const auto position = static_cast<std::size_t>(offset);
    const auto next = std::ranges::upper_bound(line_starts_, position);
    const auto line = next - line_starts_.begin();
    return {file_, static_cast<int>(line), static_cast<int>(position - *(next - 1) + 1)};
  }

  /// The place of the '<' that opens the element.
  [[nodiscard]] SourceLocation of(const pugi::xml_node& node) const {
    return at(std::max<std::ptrdiff_t>(node.offset_debug() - 1, 0));
  }

 private:
  const std::string& file_;
  std::vector<std::size_t> line_starts_;
};

/// A type as the file declares it. Its references are names until the second pass.
struct Declaration {
  pugi::xml_node node;
  Type* type = nullptr;  ///< nullptr: another name of a built-in type, or not to be used
  bool resolving = false;
  bool resolved = false;
};

class TypelibReader {
 public:
  TypelibReader(std::string_view text, const std::string& file, Diagnostics& diagnostics)
      : text_(text), places_(text, file), diagnostics_(diagnostics) {}

  std::optional<TypeRegistry> read() {
    const std::size_t errors_before = diagnostics_.error_count();
    if (parse()) {
      declare_all();
      resolve_all();
      if (diagnostics_.error_count() == errors_before) check_layouts();
    }
    if (diagnostics_.error_count() > errors_before) return std::nullopt;
    name_aliases();
    if (auto added = registry_.add_all(std::move(types_)); !added) {
      diagnostics_.error("invalid-registry", added.error().message, places_.of(document_.document_element()));
      return std::nullopt;
    }
    return std::move(registry_);
  }

 private:
  void error(const pugi::xml_node& node, std::string code, std::string message) {
    diagnostics_.error(std::move(code), std::move(message), places_.of(node));
  }

  bool parse() {
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
    if (!result) {
      diagnostics_.error("not-xml", std::string("this is not well-formed XML: ") + result.description(),
                         places_.at(result.offset));
      return false;
    }
    const pugi::xml_node root = document_.document_element();
    if (std::string_view(root.name()) == "typelib") return true;
    error(root, "not-typelib",
          "expected <typelib> as the outermost element of a type registry, got " + quote(root.name()));
    return false;
  }

  // First pass: every type by name, so that later ones may be referred to.

  void declare_all() {
    for (const pugi::xml_node& node : document_.document_element().children()) {
      if (node.type() == pugi::node_element) declare(node);
    }
  }

  void declare(const pugi::xml_node& node) {
    const std::string_view element = node.name();
    if (element == "metadata") return;
    const std::optional<TypeKind> kind = kind_of(element);
    if (!kind) {
      diagnostics_.warning("unknown-element",
                           "a type registry has no element " + quote(element) + "; ignored",
                           places_.of(node));
      return;
    }
    const std::optional<std::string> written = attribute(node, "name");
    if (!written) return;
    const Result<std::string> canonical = canonical_type_name(*written);
    if (!canonical) return error(node, "invalid-name", canonical.error().message);
    auto type = std::make_unique<Type>();
    type->kind = *kind;
    type->name = *canonical;
    read_content(node, *type);
    enter(node, *written, std::move(type));
  }

  static std::optional<TypeKind> kind_of(std::string_view element) {
    static constexpr std::array<std::pair<std::string_view, TypeKind>, 7> kKinds = {
        {{"numeric", TypeKind::Numeric},
         {"enum", TypeKind::Enum},
         {"compound", TypeKind::Compound},
         {"container", TypeKind::Container},
         {"opaque", TypeKind::Opaque},
         {"alias", TypeKind::Alias},
         {"null", TypeKind::Null}}};
    const auto* found = std::ranges::find(kKinds, element, &std::pair<std::string_view, TypeKind>::first);
    if (found == kKinds.end()) return std::nullopt;
    return found->second;
  }

  void read_content(const pugi::xml_node& node, Type& type) {
    switch (type.kind) {
      case TypeKind::Numeric:
        return read_numeric(node, type);
      case TypeKind::Enum:
        return read_enum(node, type);
      case TypeKind::Compound:
        type.size = size_attribute(node, "size").value_or(0);
        return;
      case TypeKind::Container:
        if (node.attribute("size")) type.size = size_attribute(node, "size").value_or(0);
        type.container_kind = attribute(node, "kind").value_or("");
        return;
      case TypeKind::Opaque:
        if (node.attribute("size")) type.size = size_attribute(node, "size").value_or(0);
        return;
      default:
        return;
    }
  }

  void read_numeric(const pugi::xml_node& node, Type& type) {
    const std::optional<std::string> category = attribute(node, "category");
    const std::optional<std::size_t> size = size_attribute(node, "size");
    if (!category || !size) return;
    type.size = *size;
    const bool whole = *category == "sint" || *category == "uint";
    if (!whole && *category != "float")
      return error(node, "invalid-attribute",
                   "a number's category is sint, uint or float, got " + quote(*category));
    const bool fits = *size == 4 || *size == 8 || (whole && (*size == 1 || *size == 2));
    if (!fits)
      error(node, "invalid-attribute",
            "no number of category " + *category + " has " + std::to_string(*size) + " bytes; Segue knows " +
                (whole ? "1, 2, 4 and 8" : "4 and 8"));
    type.category = *category == "float"  ? NumericCategory::Float
                    : *category == "sint" ? NumericCategory::Signed
                                          : NumericCategory::Unsigned;
    if (type.name == "/bool" && type.size == 1) type.category = NumericCategory::Bool;
  }

  void read_enum(const pugi::xml_node& node, Type& type) {
    type.size = 4;
    std::unordered_set<std::string> names;
    for (const pugi::xml_node& child : node.children("value")) {
      const std::optional<std::string> symbol = attribute(child, "symbol");
      const std::optional<std::string> text = attribute(child, "value");
      if (!symbol || !text) continue;
      std::int64_t value = 0;
      const auto [end, status] = std::from_chars(text->data(), text->data() + text->size(), value);
      if (status != std::errc{} || end != text->data() + text->size()) {
        error(child, "invalid-attribute",
              "the value of " + quote(*symbol) + " is not an integer: " + quote(*text));
      } else if (!names.insert(*symbol).second) {
        error(child, "duplicate-symbol", "enum " + quote(type.name) + " has " + quote(*symbol) + " twice");
      } else {
        type.symbols.push_back({*symbol, value});
      }
    }
  }

  /// By the name as written and by the canonical one. A built-in type may be declared again as it is.
  void enter(const pugi::xml_node& node, const std::string& written, std::unique_ptr<Type> type) {
    const bool alias = type->kind == TypeKind::Alias;
    const Type* built_in = std::as_const(registry_).find(type->name);
    if (built_in != nullptr && !alias) {
      file_sizes_[built_in] = type->size;
      if (!redeclares(*built_in, *type) && !names_only(node, *built_in, *type))
        error(node, "contradiction", quote(written) + " is a built-in type and defined otherwise here");
      return;
    }
    if (built_in != nullptr && written == type->name)
      return error(node, "contradiction", quote(written) + " is a built-in type and defined otherwise here");
    const std::size_t* earlier = find_in(by_written_, written);
    if (earlier == nullptr && !alias) earlier = find_in(by_canonical_, type->name);
    if (earlier != nullptr)
      return error(node, "duplicate-type",
                   "type " + quote(written) + " is defined twice, first in line " +
                       std::to_string(places_.of(declarations_[*earlier].node).line));
    by_written_.emplace(written, declarations_.size());
    (alias ? aliases_by_canonical_ : by_canonical_).emplace(type->name, declarations_.size());
    if (alias) type->name = written;
    declarations_.push_back({node, type.get(), false, false});
    types_.push_back(std::move(type));
  }

  using Index = std::unordered_map<std::string, std::size_t>;

  static const std::size_t* find_in(const Index& index, const std::string& name) {
    const auto found = index.find(name);
    return found == index.end() ? nullptr : &found->second;
  }

  static bool redeclares(const Type& built_in, const Type& type) {
    if (built_in.kind != type.kind) return false;
    if (type.kind == TypeKind::Numeric)
      return built_in.size == type.size && built_in.category == type.category;
    return built_in.container_kind == type.container_kind;
  }

  /// Old registries know the name of /std/string but not its content.
  static bool names_only(const pugi::xml_node& node, const Type& built_in, const Type& type) {
    if (built_in.kind != TypeKind::Container) return false;
    return type.kind == TypeKind::Null ||
           (type.kind == TypeKind::Opaque && *node.attribute("marshal_as").value() == '\0');
  }

  // Second pass: names become types.

  void resolve_all() {
    const std::size_t declared = declarations_.size();  // resolving adds arrays and vectors to types_ only
    for (std::size_t i = 0; i < declared; ++i)
      resolve(declarations_[i], 0);
  }

  void resolve(Declaration& declaration, int depth) {
    if (declaration.resolved) return;
    declaration.resolving = true;
    const pugi::xml_node& node = declaration.node;
    Type& type = *declaration.type;
    if (type.kind == TypeKind::Alias) type.element = referred(node, "source", depth);
    if (type.kind == TypeKind::Container) type.element = referred(node, "of", depth);
    if (type.kind == TypeKind::Opaque && *node.attribute("marshal_as").value() != '\0')
      type.element = referred(node, "marshal_as", depth);
    if (type.kind == TypeKind::Compound) resolve_fields(node, type, depth);
    declaration.resolving = false;
    declaration.resolved = true;
  }

  void resolve_fields(const pugi::xml_node& node, Type& type, int depth) {
    std::unordered_set<std::string> names;
    for (const pugi::xml_node& child : node.children("field")) {
      const std::optional<std::string> name = attribute(child, "name");
      const std::optional<std::size_t> offset = size_attribute(child, "offset");
      const Type* field = referred(child, "type", depth);
      if (!name || !offset || field == nullptr) continue;
      if (!names.insert(*name).second)
        error(child, "duplicate-field",
              "compound " + quote(type.name) + " has the field " + quote(*name) + " twice");
      type.fields.push_back({*name, field, *offset});
      field_nodes_[&type].push_back(child);
    }
  }

  /// The type that an attribute names, through aliases; reports what is missing or unknown.
  const Type* referred(const pugi::xml_node& node, const char* key, int depth) {
    const std::optional<std::string> name = attribute(node, key);
    if (!name) return nullptr;
    const Result<std::string> canonical = canonical_type_name(*name);
    if (!canonical) {
      error(node, "invalid-name", canonical.error().message);
      return nullptr;
    }
    bool reported = false;
    const Type* type = find(node, *name, *canonical, depth, reported);
    if (type == nullptr && !reported) unknown_type(node, *name);
    return type;
  }

  void unknown_type(const pugi::xml_node& node, const std::string& name) {
    constexpr int kMostHints = 20;  // each compares with every name
    std::vector<std::string> known;
    if (hints_++ < kMostHints) {
      for (const auto& [written, index] : by_written_)
        known.push_back(written);
    }
    error(node, "unknown-type",
          "type " + quote(name) + " is not defined in this registry" + did_you_mean(name, known));
  }

  /// By the name as written first: "/long" of another machine may differ from this one's.
  const Type* find(const pugi::xml_node& node, std::string_view written, const std::string& canonical,
                   int depth, bool& reported) {
    const std::size_t* declared = find_in(by_written_, std::string(written));
    if (declared == nullptr) declared = find_in(by_canonical_, canonical);
    const Type* built_in = std::as_const(registry_).find(canonical);
    if (declared == nullptr && built_in != nullptr) return built_in;
    if (declared == nullptr) declared = find_in(aliases_by_canonical_, canonical);
    if (declared != nullptr) return through_alias(node, declarations_[*declared], depth, reported);
    return composite(node, written, canonical, depth, reported);
  }

  const Type* through_alias(const pugi::xml_node& node, Declaration& declaration, int depth, bool& reported) {
    if (declaration.type->kind != TypeKind::Alias) return declaration.type;
    if (declaration.resolving || depth > kLongestChain) {
      error(node, "alias-circle",
            "alias " + quote(declaration.type->name) +
                " stands for itself, or the chain of aliases is too long");
      reported = true;
      return nullptr;
    }
    resolve(declaration, depth + 1);
    reported = declaration.type->element == nullptr;
    return declaration.type->element;
  }

  const Type* composite(const pugi::xml_node& node, std::string_view written, const std::string& canonical,
                        int depth, bool& reported) {
    for (const std::string_view spelling : {written, std::string_view(canonical)}) {
      const detail::CompositeName name = detail::split_composite(spelling);
      if (name.kind == TypeKind::Null) continue;
      const Result<std::string> inner = canonical_type_name(name.element);
      const Type* element = inner ? find(node, name.element, *inner, depth, reported) : nullptr;
      if (element != nullptr) return build(node, name, *element, reported);
      if (reported) return nullptr;
    }
    return nullptr;
  }

  const Type* build(const pugi::xml_node& node, const detail::CompositeName& name, const Type& element,
                    bool& reported) {
    std::optional<Type> type = detail::make_composite(name, element);
    if (!type) {
      error(node, "too-large",
            "an array of " + std::to_string(name.count) + " " + quote(element.name) + " fits into no memory");
      reported = true;
      return nullptr;
    }
    const auto declared = by_canonical_.find(type->name);
    if (declared != by_canonical_.end() && declarations_[declared->second].type->kind != TypeKind::Alias)
      return declarations_[declared->second].type;
    const auto [known, added] = composites_.try_emplace(type->name, nullptr);
    if (!added) return known->second;
    types_.push_back(std::make_unique<Type>(std::move(*type)));
    return known->second = types_.back().get();
  }

  // Third pass.

  void check_layouts() {
    std::vector<const Type*> types;
    std::unordered_map<const Type*, pugi::xml_node> nodes;
    for (const Declaration& declaration : declarations_) {
      types.push_back(declaration.type);
      nodes.emplace(declaration.type, declaration.node);
    }
    for (detail::LayoutProblem& problem : detail::check_layouts(types, file_sizes_)) {
      const pugi::xml_node node = problem.field == detail::kNoField
                                      ? nodes[problem.type]
                                      : field_nodes_.at(problem.type).at(problem.field);
      diagnostics_.add(
          {problem.severity, std::move(problem.code), std::move(problem.message), places_.of(node)});
    }
  }

  /// Aliases by their canonical names, but where another type has that name: one that only spells its own
  /// target otherwise ("/int" for "/int32_t") is not needed, one that contradicts ("/long" with four bytes)
  /// keeps the name it was written with.
  void name_aliases() {
    std::unordered_map<std::string, const Type*> taken;
    for (const Type* built_in : registry_.types())
      taken.emplace(built_in->name, built_in);
    for (const auto& type : types_) {
      if (type->kind != TypeKind::Alias) taken.emplace(type->name, type.get());
    }
    std::unordered_set<const Type*> needless;
    for (const auto& type : types_) {
      if (type->kind != TypeKind::Alias) continue;
      const std::string canonical = *canonical_type_name(type->name);
      const auto [at, is_new] = taken.try_emplace(canonical, type->element);
      if (is_new) type->name = canonical;
      if (!is_new && at->second == type->element) needless.insert(type.get());
    }
    std::erase_if(types_, [&](const auto& type) { return needless.contains(type.get()); });
  }

  // Attributes.

  std::optional<std::string> attribute(const pugi::xml_node& node, const char* key) {
    const pugi::xml_attribute found = node.attribute(key);
    if (found && *found.value() != '\0') return std::string(found.value());
    error(node, "missing-attribute", "<" + std::string(node.name()) + "> needs an attribute " + quote(key));
    return std::nullopt;
  }

  std::optional<std::size_t> size_attribute(const pugi::xml_node& node, const char* key) {
    constexpr std::size_t kMost = std::size_t{1} << 48;
    const std::optional<std::string> text = attribute(node, key);
    if (!text) return std::nullopt;
    std::size_t number = 0;
    const auto [end, status] = std::from_chars(text->data(), text->data() + text->size(), number);
    if (status == std::errc{} && end == text->data() + text->size() && number <= kMost) return number;
    error(node, "invalid-attribute",
          "attribute " + quote(key) + " is not a number of bytes: " + quote(*text));
    return std::nullopt;
  }

  std::string_view text_;
  ElementPlaces places_;
  Diagnostics& diagnostics_;
  pugi::xml_document document_;
  TypeRegistry registry_;
  std::vector<std::unique_ptr<Type>> types_;
  std::vector<Declaration> declarations_;
  int hints_ = 0;
  Index by_written_;
  Index by_canonical_;  ///< all but aliases
  Index aliases_by_canonical_;
  std::unordered_map<std::string, const Type*> composites_;
  std::unordered_map<const Type*, std::size_t> file_sizes_;  ///< of built-in types, as the file has them
  std::unordered_map<const Type*, std::vector<pugi::xml_node>> field_nodes_;
};

}  // namespace

std::optional<TypeRegistry> read_typelib(std::string_view text, const std::string& file,
                                         Diagnostics& diagnostics) {
  return TypelibReader(text, file, diagnostics).read();
}

std::optional<TypeRegistry> load_typelib(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const Result<std::string> text = read_file(file);
  if (!text) {
    diagnostics.error("unreadable", text.error().message, {file.string(), 0, 0});
    return std::nullopt;
  }
  return read_typelib(*text, file.string(), diagnostics);
}

}  // namespace segue::type
