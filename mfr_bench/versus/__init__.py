"""Two source trees measured in turns: both processes are up at once, and a load or a clock hits both.

    tree      a folder or a git revision as a tree of files, of this program or of a package of methods
    side      the process of one tree: runs with that tree's own code, by lines of JSON
    link      the parent's end of it
    lockstep  rounds of pairs: a batch of frames here, a batch there
    judge     the verdict on each cell, by the rules of `compare`
"""
