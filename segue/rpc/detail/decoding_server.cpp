// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc/detail/decoding_server.hpp>

#include <capnp/dynamic.h>

namespace segue::control::detail {

void answer_with_error(capnp::InterfaceSchema::Method method, const Error& error,
                       capnp::CallContext<capnp::AnyPointer, capnp::AnyPointer> context) {
  auto results = context.getResults().initAs<capnp::DynamicStruct>(method.getResultType());
  const bool has_error = method.getResultType().findFieldByName("error") != nullptr;
  auto answer = has_error ? results : results.init("answer").as<capnp::DynamicStruct>();
  encode(error, answer.init("error").as<capnp::DynamicStruct>().as<wire::Error>());
}

}  // namespace segue::control::detail
