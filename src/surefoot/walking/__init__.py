"""The pendulum model, its safety theorems, the step library and the keyframe decision maker."""
