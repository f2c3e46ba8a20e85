
def execute(self, inputs, outputs, gvm):
    if self.preemptive_wait(60):
        return -2
    return 0
