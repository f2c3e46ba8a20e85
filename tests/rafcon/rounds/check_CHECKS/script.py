def execute(self, inputs, outputs, gvm):
    rounds = self.persistent_variables.get("rounds", 0) + 1
    self.persistent_variables["rounds"] = rounds
    gvm.set_variable("rounds", rounds)
    return 0 if inputs["count"] < inputs["limit"] else 1
