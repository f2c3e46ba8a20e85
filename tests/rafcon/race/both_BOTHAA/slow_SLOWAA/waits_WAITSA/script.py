def execute(self, inputs, outputs, gvm):
    gvm.set_variable("waits", True)
    outputs["who"] = "slow, " + ("preempted" if self.preemptive_wait(60) and self.preempted else "late")
    return "late"
