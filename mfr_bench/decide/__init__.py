"""From a question to a decision: which methods may keep its bounds, which config measures them, what the rows say.

    question    what was asked: size, layers, coverage, memory, error, time
    budget      the time that the answer may take, and what is set aside for its end
    candidates  the methods that may keep the bounds, with parameters; and why each of the others cannot
    experiment  the config that lets the candidates race
    answer      the method, how sure that is, who comes close, as text and JSON
"""
