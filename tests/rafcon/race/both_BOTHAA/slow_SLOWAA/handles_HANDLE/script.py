def execute(self, inputs, outputs, gvm):
    gvm.set_variable("handled", not self.preempted)
    return "success"
