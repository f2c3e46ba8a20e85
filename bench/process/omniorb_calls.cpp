// SPDX-License-Identifier: Apache-2.0
#include "calls.hpp"

#include <omniORB4/CORBA.h>
#include <unistd.h>

#include <cstring>
#include <string>

#include "task.hh"

namespace bench {
namespace {

class Servant : public POA_bench_corba::Task {
 public:
  void configure() override {}
  void start() override {}
  void stop() override {}
};

CORBA::ORB_var open_orb(Way way) {
  int count = 1;
  char name[] = "bench";
  char* arguments[] = {name, nullptr};
  const char* options[][2] = {{"endPoint", way == Way::Tcp ? "giop:tcp:127.0.0.1:" : "giop:unix:"},
                              {nullptr, nullptr}};
  return CORBA::ORB_init(count, arguments, "omniORB4", options);
}

void serve(Way way, const End& end) {
  const CORBA::ORB_var orb = open_orb(way);
  const CORBA::Object_var found = orb->resolve_initial_references("RootPOA");
  const PortableServer::POA_var poa = PortableServer::POA::_narrow(found);
  Servant servant;
  const PortableServer::ObjectId_var id = poa->activate_object(&servant);
  const CORBA::Object_var object = poa->id_to_reference(id);
  const CORBA::String_var reference = orb->object_to_string(object);
  const PortableServer::POAManager_var manager = poa->the_POAManager();
  manager->activate();
  if (::write(end.socket, reference.in(), std::strlen(reference)) > 0) orb->run();
}

bool ask(Way way, const End& end, std::size_t repeat) {
  std::string reference(65536, '\0');
  const ssize_t size = ::read(end.socket, reference.data(), reference.size());
  if (size <= 0) return false;
  reference.resize(static_cast<std::size_t>(size));
  const CORBA::ORB_var orb = open_orb(way);
  const CORBA::Object_var object = orb->string_to_object(reference.c_str());
  const bench_corba::Task_var task = bench_corba::Task::_narrow(object);
  if (CORBA::is_nil(task)) return false;
  for (std::size_t i = 0; i < repeat; ++i) {
    const std::int64_t begin = clock_ns();
    task->start();
    end.board.add_result(Duration(clock_ns() - begin));
  }
  return true;
}

}  // namespace

std::optional<Summary> omniorb_calls(Way way, std::size_t repeat) {
  return run_pair(
      {}, [&](const End& end) { return ask(way, end, repeat); }, [&](const End& end) { serve(way, end); });
}

bool has_omniorb() {
  return true;
}

}  // namespace bench
