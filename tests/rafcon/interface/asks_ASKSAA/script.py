def execute(self, inputs, outputs, gvm):
    told = {"name": self.name, "id": self.state_id, "path": self.get_path(by_name=True), "inputs": dict(inputs)}
    told["outcomes"] = {str(number): [outcome.outcome_id, outcome.name] for number, outcome in sorted(self.outcomes.items())}
    told["run_id"] = isinstance(self.run_id, str) and len(self.run_id) > 0
    told["flags"] = [self.preempted, self.paused, self.started]
    told["waits"] = [self.preemptive_wait(0), self.wait_for_interruption(0), self.wait_for_unpause(0)]
    self.logger.debug("asks")
    self.persistent_variables["asked"] = True

    gvm.set_variable("text", "a", data_type=str)
    try:
        gvm.set_variable("text", 3)
        told["typed"] = False
    except (TypeError, RuntimeError):
        told["typed"] = True
    told["default"] = gvm.get_variable("nothing there", default=4)
    key = gvm.lock_variable("text")
    told["locked"] = [gvm.is_locked("text"), gvm.lock_variable("text"), bool(key)]
    gvm.set_locked_variable("text", key, "b")
    told["text"] = gvm.get_locked_variable("text", key)
    try:
        gvm.unlock_variable("text", 12345)
        told["wrong_key"] = False
    except RuntimeError:
        told["wrong_key"] = True
    gvm.unlock_variable("text", key)
    gvm.lock_variable("text", block=True)
    gvm.unlock_variable("text", None, force=True)
    gvm.set_variable("other", [1, {"x": None}], per_reference=False, access_key=None)
    told["keys"] = sorted(gvm.get_all_keys())
    told["starting"] = gvm.get_all_keys_starting_with("te")
    told["all"] = {key: value for key, value in sorted(gvm.get_all_variables().items())}
    told["there"] = [gvm.variable_exist("text"), gvm.variable_exists("nothing there")]
    told["reference"] = gvm.global_variable_dictionary["text"]
    gvm.delete_variable("other")
    told["deleted"] = gvm.variable_exist("other")
    outputs["told"] = told
    return "all"
