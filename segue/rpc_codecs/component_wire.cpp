// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/model_wire.hpp>

namespace segue::control::detail {

namespace {

using model::ArgumentModel;
using model::OperationModel;
using model::PortModel;
using model::PropertyModel;

void encode_port(const PortModel& port, wire::Component::Port::Builder builder) {
  builder.setName(as_text(port.name));
  builder.setDirection(static_cast<std::uint8_t>(port.direction));
  builder.setDynamic(port.dynamic);
  builder.setPattern(port.pattern);
  builder.setType(as_text(port.type));
  builder.setDoc(as_text(port.doc));
}

PortModel decode_port(wire::Component::Port::Reader reader) {
  return {as_string(reader.getName()), enum_from(reader.getDirection(), model::Direction::Output),
          as_string(reader.getType()), reader.getDynamic(),
          reader.getPattern(),         as_string(reader.getDoc())};
}

void encode_property(const PropertyModel& property, wire::Component::Property::Builder builder) {
  builder.setName(as_text(property.name));
  builder.setType(as_text(property.type));
  put(property.default_value, builder.initDefault());
  builder.setLive(property.live);
  builder.setDoc(as_text(property.doc));
}

PropertyModel decode_property(wire::Component::Property::Reader reader) {
  return {as_string(reader.getName()), as_string(reader.getType()), get(reader.getDefault()),
          reader.getLive(), as_string(reader.getDoc())};
}

void encode_argument(const ArgumentModel& argument, wire::Component::Argument::Builder builder) {
  builder.setName(as_text(argument.name));
  builder.setType(as_text(argument.type));
  builder.setDoc(as_text(argument.doc));
}

ArgumentModel decode_argument(wire::Component::Argument::Reader reader) {
  return {as_string(reader.getName()), as_string(reader.getType()), as_string(reader.getDoc())};
}

void encode_operation(const OperationModel& operation, wire::Component::Operation::Builder builder) {
  builder.setName(as_text(operation.name));
  encode_list(operation.arguments, builder.initArguments(count_of(operation.arguments)), encode_argument);
  builder.setResult(as_text(operation.result));
  builder.setCallerThread(operation.caller_thread);
  builder.setDoc(as_text(operation.doc));
}

OperationModel decode_operation(wire::Component::Operation::Reader reader) {
  return {as_string(reader.getName()), decode_list<ArgumentModel>(reader.getArguments(), decode_argument),
          as_string(reader.getResult()), reader.getCallerThread(), as_string(reader.getDoc())};
}

}  // namespace

void encode(const model::ComponentModel& model, wire::Component::Builder builder) {
  builder.setName(as_text(model.name.str()));
  builder.setDoc(as_text(model.doc));
  builder.setLibrary(as_text(model.library));
  builder.setAbstract(model.abstract);
  builder.setIncomplete(model.incomplete);
  builder.setOwnActivity(model.own_activity);
  encode_list(model.ports, builder.initPorts(count_of(model.ports)), encode_port);
  encode_list(model.properties, builder.initProperties(count_of(model.properties)), encode_property);
  encode_list(model.operations, builder.initOperations(count_of(model.operations)), encode_operation);
  encode(model.activity, builder.initActivity());
  encode(model.trigger_ports, builder.initTriggerPorts(count_of(model.trigger_ports)));
  encode(model.descriptors, builder.initDescriptors(count_of(model.descriptors)));
  encode(model.nominal_states, builder.initNominalStates(count_of(model.nominal_states)));
  encode(model.error_states, builder.initErrorStates(count_of(model.error_states)));
  encode(model.exclusive, builder.initExclusive(count_of(model.exclusive)));
  builder.setParent(as_text(model.parent));
}

model::ComponentModel decode(wire::Component::Reader reader) {
  model::ComponentModel model;
  model.name = model::ComponentName(as_string(reader.getName()));
  model.doc = as_string(reader.getDoc());
  model.library = as_string(reader.getLibrary());
  model.abstract = reader.getAbstract();
  model.incomplete = reader.getIncomplete();
  model.own_activity = reader.getOwnActivity();
  model.ports = decode_list<PortModel>(reader.getPorts(), decode_port);
  model.properties = decode_list<PropertyModel>(reader.getProperties(), decode_property);
  model.operations = decode_list<OperationModel>(reader.getOperations(), decode_operation);
  model.activity = decode(reader.getActivity());
  model.trigger_ports = decode(reader.getTriggerPorts());
  model.descriptors = decode(reader.getDescriptors());
  model.nominal_states = decode(reader.getNominalStates());
  model.error_states = decode(reader.getErrorStates());
  model.exclusive = decode(reader.getExclusive());
  model.parent = as_string(reader.getParent());
  return model;
}

}  // namespace segue::control::detail
