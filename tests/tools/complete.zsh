# complete.zsh FOLDER LINE WORD: starts an interactive zsh that finds completions in FOLDER, types LINE, asks for the
# list of completions and waits until WORD appears. LINE must not have WORD in it, for the terminal echoes what is typed.
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "fpath=(${(q)1} \$fpath); autoload -Uz compinit; compinit -u -D; stty columns 200 rows 1000; LISTMAX=1000"
zpty -w shell "bindkey '^X' list-choices; echo REA''DY"  # the quotes keep the echo of the command from matching
zpty -r shell shown '*READY*'
zpty -w -n shell "$2"$'\x18'
zpty -r shell shown "*$3*"
found=$?
zpty -d shell
exit $found
