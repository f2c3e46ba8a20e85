// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/task_host/component_library.hpp>

#include <fmt/core.h>

#include <memory>

#include "../models.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

using model::ComponentModel;
using type::Value;

struct ComponentOptions {
  std::string name;
  std::string output;
  ModelSources sources;
};

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

std::vector<std::string> component_names(const model::ComponentCatalog& catalog) {
  std::vector<std::string> names;
  for (const ComponentModel* component : catalog.all())
    names.push_back(component->name.str());
  return names;
}

int list_components(const ComponentOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  if (diagnostics.has_errors()) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  if (context.json()) {
    Value::List items;
    for (const ComponentModel* component : catalog.all())
      items.push_back(model::to_value(*component));
    print_json(Value(std::move(items)));
    return kDone;
  }
  if (catalog.size() == 0) {
    print_note(
        "no component library is installed; the folders searched are those of $SEGUE_LIBRARY_PATH and "
        "lib/segue beside the program");
    return kDone;
  }
  Table table({{"COMPONENT"}, {"LIBRARY"}, {"DESCRIPTION"}});
  for (const ComponentModel* component : catalog.all()) {
    table.add({component->name.str(), component->library.empty() ? "-" : component->library,
               printable(first_line(component->doc))});
  }
  print(table.text());
  return kDone;
}

std::string model_ports_text(const ComponentModel& component) {
  Table table({{"PORT"}, {"DIRECTION"}, {"TYPE"}, {"DESCRIPTION"}});
  for (const auto& port : component.ports) {
    const std::string kind = port.pattern ? " (family)" : port.dynamic ? " (dynamic)" : "";
    table.add({port.name, std::string(to_string(port.direction)) + kind, port.type, printable(port.doc)});
  }
  return component.ports.empty() ? std::string() : '\n' + table.text();
}

std::string model_properties_text(const ComponentModel& component) {
  Table table({{"PROPERTY"}, {"TYPE"}, {"DEFAULT"}, {"LIVE"}, {"DESCRIPTION"}});
  for (const auto& property : component.properties) {
    table.add({property.name, property.type, type::describe(property.default_value),
               property.live ? "yes" : "no", printable(property.doc)});
  }
  return component.properties.empty() ? std::string() : '\n' + table.text();
}

std::string model_operations_text(const ComponentModel& component) {
  Table table({{"OPERATION"}, {"RESULT"}, {"DESCRIPTION"}});
  for (const auto& operation : component.operations) {
    std::string arguments;
    for (const auto& argument : operation.arguments) {
      arguments += (arguments.empty() ? "" : ", ") + argument.name + ": " + argument.type;
    }
    table.add({fmt::format("{}({})", operation.name, arguments),
               operation.result.empty() ? "-" : operation.result, printable(operation.doc)});
  }
  return component.operations.empty() ? std::string() : '\n' + table.text();
}

int show_component(const ComponentOptions& options, const Context& context) {
  Diagnostics diagnostics;
  const auto catalog = load_catalog(options.sources, diagnostics);
  if (diagnostics.has_errors()) return report_failure(context, diagnostics);
  const ComponentModel* component = catalog.find(model::ComponentName(options.name));
  if (component == nullptr) {
    return failed(context,
                  fail(ErrorCode::NotFound, "no component " + quote(options.name) + " is known" +
                                                did_you_mean(options.name, component_names(catalog)) +
                                                "; `segue component list` lists all components"));
  }
  if (context.json()) {
    print_json(model::to_value(*component));
    return kDone;
  }
  print(coloured(Colour::Bold, component->name.str()) + '\n');
  if (!component->doc.empty()) print(printable(component->doc) + '\n');
  if (!component->library.empty()) print("library: " + component->library + '\n');
  print(model_ports_text(*component) + model_properties_text(*component) + model_operations_text(*component));
  return kDone;
}

int export_models(const ComponentOptions& options, const Context& context) {
  task_host::LibrarySet libraries;
  const auto loaded = libraries.load(options.name);
  if (!loaded) return failed(context, loaded.error());
  const auto text = task_host::write_library_models(libraries, options.name);
  if (!text) return failed(context, text.error());
  return write_or_print(context, options.output, *text);
}

}  // namespace

void add_component(Verb& app, Context& context) {
  const auto options = std::make_shared<ComponentOptions>();
  Verb& verb = add_verb(app, context, "component", "component libraries and models",
                        "  segue component list\n  segue component show demo::Drive", nullptr);
  verb.require_verb();
  Verb& lister = add_verb(verb, context, "list", "list all known components", "  segue component list",
                          [options, &context] { return list_components(*options, context); });
  add_model_options(lister, options->sources);
  Verb& shower = add_verb(verb, context, "show", "show the interface of a component",
                          "  segue component show demo::Drive",
                          [options, &context] { return show_component(*options, context); });
  shower.option("COMPONENT", options->name, "the component").required();
  add_model_options(shower, options->sources);
  Verb& exporter =
      add_verb(verb, context, "export", "write the component models of a library to a file for tools",
               "  segue component export segue_components_demo -o demo.components.yaml",
               [options, &context] { return export_models(*options, context); });
  exporter.option("LIBRARY", options->name, "a library's name").required();
  exporter.option("-o,--output FILE", options->output, "write to a file instead of standard output");
}

}  // namespace segue::cli
