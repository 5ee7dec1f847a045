// The whole machine as one unit; the generated shaders are another.
#include "explore.cpp"
#include "frame.cpp"
#include "lockstep.cpp"
#include "main.cpp"
#include "memory.cpp"
#include "schedule.cpp"
