// Carries the precompiled header that the test programs share; no test of its own.
