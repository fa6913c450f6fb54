# complete.zsh FOLDER LINE WORD ...: starts an interactive zsh that finds completions in FOLDER, types each LINE, asks
# for the list of completions and waits until the WORD behind it appears. A LINE must not have its WORD in it, for the
# terminal echoes what is typed.
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell "fpath=(${(q)1} \$fpath); autoload -Uz compinit; compinit -u -D; stty columns 200 rows 1000; LISTMAX=1000"
zpty -w shell "bindkey '^X' list-choices; echo REA''DY"  # the quotes keep the echo of the command from matching
zpty -r shell shown '*READY*'
for line word in "${@:2}"; do
  print -r -- "$line"
  zpty -w -n shell "$line"$'\x18'
  zpty -r shell shown "*$word*" || exit
  zpty -w shell $'\x15'"echo NE''XT"  # in place of that line
  zpty -r shell shown '*NEXT*' || exit
done
zpty -d shell
